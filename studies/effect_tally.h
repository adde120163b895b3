#pragma once

#include <map>
#include <string>

#include "diagnosis/states/explain_states.h"

namespace hydroscope {

/// What `explain` made of logs with a hidden effect ("-": none), effect by effect.
class EffectTally {
 public:
  /// One line of what was found.
  std::string Add(const std::string& hidden, double size, const StatesExplanation& explanation);
  /// Per effect and in all, a table.
  std::string Table() const;
  /// At least 95 % named first, at most 1 % of all sets without what was hidden.
  bool Reached() const;

 private:
  struct Counts {
    int cases = 0, first = 0, ambiguous = 0, unknown = 0, adequate = 0, wrong = 0;
    void Add(const Counts& other);
  };
  Counts Hidden() const;
  std::map<std::string, Counts> counts_;
};

}  // namespace hydroscope
