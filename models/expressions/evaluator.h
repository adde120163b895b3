#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "models/expressions/program.h"

namespace hydroscope {

/// An expression without ddt, compiled to be computed on channels of values.
class ExpressionEvaluator {
 public:
  /// `channel_of` gives each name's index into the channels. All names must be there (they are checked when
  /// the machine file is read).
  ExpressionEvaluator(const ExpressionNode& expression, const std::map<std::string, int>& channel_of);

  /// Values at samples first, first + 1, ...; not finite (division by zero, root of a negative value) comes out as it
  /// is. `channels[i]` is what `channel_of` called i.
  void Values(const std::vector<std::vector<double>>& channels, int first, std::span<double> values) const;

  const std::vector<int>& channels() const { return channels_; }

 private:
  std::vector<int> channels_;  ///< those it reads: the inputs of the program
  ExpressionProgram program_;
};

}  // namespace hydroscope
