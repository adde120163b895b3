#pragma once

#include <string>
#include <vector>

#include "core/records/sample_block.h"
#include "core/result.h"
#include "replay/log_reader.h"

namespace hydroscope {

/// Flags that TimeChecker sets.
inline constexpr Quality kOfTheTime =
    quality::kGap | quality::kTimeBackwards | quality::kClockJump | quality::kDuplicate;

/// Share of rows that repeat the time stamp of the row before, from which on stamps are coarser than rows.
inline constexpr double kCoarseShare = 0.1;

/// Nominal time between rows: mean of the differences within 0.5...1.5 times their median, taken as 1/n s if
/// it is that close (1e-6) to a whole number n of rows per second. NaN if no two times increase.
double SamplePeriodOf(const std::vector<double>& times);

/// Longest step, s, between rows of which none is missing: 1.5 periods, and a step of the stamps more where that is a fifth of a
/// period and more (2 ms rows in whole ms are up to 3 ms apart), as long as a missing row still shows.
double LongestStep(const std::vector<double>& times, double period);

/// Whether each time lies before the one of the row before, and what to do then.
bool Falls(const std::vector<double>& times);
tl::unexpected<Error> NewestFirst(const std::string& origin, const std::string& column);

/// Why no period was found in the times of the first rows, s, and what to do.
tl::unexpected<Error> NoSamplePeriod(const std::string& origin, const std::string& column,
                                     const std::vector<double>& times, const std::string& unit);

/// Flags rows by their time stamps, on all channels of the row, independent of how rows are cut into blocks:
///   kDuplicate      the time of the row before again
///   kTimeBackwards  earlier than the row before; rows stay flagged until time has passed the latest one
///   seen, unless
///                   the step is a clock jump
///   kGap            farther from the row before than the longest step
///   kClockJump      forward step of more than 10 s, backward step of more than 1 s: a new time base from
///   here on
class TimeChecker {
 public:
  /// `sample_period` and `longest_step` (LongestStep) in s.
  TimeChecker(double sample_period, double longest_step)
      : sample_period_(sample_period), longest_step_(longest_step) {}
  explicit TimeChecker(double sample_period) : TimeChecker(sample_period, 1.5 * sample_period) {}
  /// Checks the rows of `block`; counts the values flagged.
  void Check(SampleBlock& block, LogCounters& counters);

 private:
  bool AllRegular(const SampleBlock& block) const;
  Quality FlagsOf(double time);

  double sample_period_, longest_step_;  ///< s
  bool started_ = false;
  double reference_ = 0;  ///< s, latest time of the present time base
};

}  // namespace hydroscope
