#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/records/sample_block.h"
#include "models/machine.h"

namespace hydroscope {

/// What the readings of one signal looked like, whatever their flags say, without missing ones and spikes.
struct SignalRange {
  double min = std::numeric_limits<double>::infinity();   ///< SI
  double max = -std::numeric_limits<double>::infinity();  ///< SI
  double sum = 0;                                         ///< SI
  std::int64_t readings = 0;                              ///< values that are there
  std::int64_t good = 0;                                  ///< values without any flag
  std::array<std::int64_t, 16> flagged{};                 ///< per flag bit
  std::array<double, 16> first{};                         ///< s, time of the first value with that flag

  bool seen() const { return readings > 0; }
  double mean() const { return sum / static_cast<double>(readings); }
};

/// How the rows follow each other.
struct TimeSurvey {
  std::int64_t rows = 0;
  double first = 0, last = 0;  ///< s
  double jitter = 0;           ///< s, standard deviation of the steps about the sample period, gaps left out
  std::int64_t gaps = 0;       ///< rows that the reader flags as such
  double longest_gap = 0;      ///< s
  std::int64_t not_forward = 0;  ///< steps that do not go forward in time
};

/// How often one condition of the gate held.
struct ConditionSurvey {
  std::string condition;      ///< "y_v >= 0.04 (1)", in the display unit
  double share = 0;           ///< of the blocks it could be judged on
  double share_mirrored = 0;  ///< share if the signal's sign were reversed
};

/// How often all conditions of the gate hold at once.
struct GateSurvey {
  double share = 0;  ///< of the blocks
  /// Signals with whose sign reversed they would hold, and how often.
  std::vector<std::pair<std::string, double>> mirrored;
};

/// Looks at the samples of a log as they pass; in SI. `sample_period` in s.
class SignalSurvey {
 public:
  SignalSurvey(const Machine& machine, double sample_period);
  void Observe(const SampleBlock& block);

  const std::vector<SignalRange>& ranges() const { return ranges_; }
  TimeSurvey time() const;
  std::vector<ConditionSurvey> conditions() const;
  GateSurvey gate() const;

 private:
  struct Condition {
    int signal = -1;
    bool rate = false, magnitude = false;
    double min = 0, max = 0;  ///< SI
    double mean[3] = {};      ///< the last block means, oldest first
    double sum = 0;           ///< of the block under way
    int count = 0, blocks = 0;
    bool whole = true;  ///< no value of the block was missing
    std::int64_t judged = 0;
    /// Per block: whether it held, and whether it did with the signal's sign reversed. A rate is judged one block late.
    std::vector<bool> held_in, mirrored_in;
  };

  void ObserveTime(double time, bool gap);
  void ObserveSignal(const SampleBlock& block, std::size_t signal);
  void ObserveCondition(const SampleBlock& block, Condition& condition) const;
  void JudgeBlock(Condition& condition) const;

  const Machine& machine_;
  double period_;
  int block_rows_;
  std::vector<SignalRange> ranges_;
  std::vector<Condition> conditions_;
  TimeSurvey time_;
  double squares_ = 0;
  std::int64_t steps_ = 0;
};

}  // namespace hydroscope
