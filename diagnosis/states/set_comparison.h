#pragma once

#include <vector>

#include "diagnosis/states/explain_states.h"

namespace hydroscope {

/// Which of two sets of effects explains more, by what each leaves of pieces of the log left out.
class SetComparison {
 public:
  explicit SetComparison(const ExplainStatesOptions& options) : options_(options) {}

  /// Whether a set does better than another, of which `left` is left.
  bool Better(const StateCandidate& now, const StateRemainder& left, const StateCandidate& next) const;
  /// Whether energies are hardly worse than the best, which removed `removed`; `noise` is one piece of evidence.
  bool HardlyWorse(const std::vector<double>& other, const std::vector<double>& best, double removed,
                   double noise) const;
  /// The same of sets.
  bool NearlyAsGood(const StateCandidate& other, const StateCandidate& best, double removed) const;
  /// What of the predictable energy a set may leave and be complete.
  double LeftShare(const StateCandidate& set) const;
  /// Whether what a set leaves is no white noise.
  bool Coloured(const StateCandidate& set) const { return LeavesColoured(set, options_.white_readings); }

 private:
  const ExplainStatesOptions& options_;
};

}  // namespace hydroscope
