#include "replay/time_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/told_error.h"

namespace hydroscope {
namespace {

constexpr double kGapPeriods = 1.5;
constexpr double kRoundingOfStamps = 0.01;  ///< of a step of the stamps
constexpr double kCoarseStamps = 0.2;       ///< of a period
constexpr double kForwardJump = 10.0;       // s
constexpr double kBackwardJump = 1.0;       // s

/// Largest power of ten, s, that all times are multiples of; 0: none that matters.
double StepOfStamps(const std::vector<double>& times) {
  for (const double step : {1.0, 0.1, 0.01, 1e-3, 1e-4}) {
    const auto is_multiple = [&](double time) {
      return std::abs(time / step - std::round(time / step)) < kRoundingOfStamps;
    };
    if (std::ranges::all_of(times, is_multiple)) return step;
  }
  return 0;
}

}  // namespace

double LongestStep(const std::vector<double>& times, double period) {
  const double stamps = StepOfStamps(times), missing = 2 * period - 0.5 * stamps;
  if (stamps < kCoarseStamps * period) return kGapPeriods * period;
  return std::max(kGapPeriods * period, std::min(kGapPeriods * period + stamps, missing));
}

double SamplePeriodOf(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = steps.begin() + steps.size() / 2;
  std::nth_element(steps.begin(), middle, steps.end());
  const double median = *middle;
  double sum = 0;
  int count = 0;
  for (const double step : steps) {
    if (step < 0.5 * median || step > 1.5 * median) continue;
    sum += step;
    ++count;
  }
  const double period = sum / count;
  const double rate = std::round(1.0 / period);
  return rate >= 1 && std::abs(rate * period - 1.0) < 1e-6 ? 1.0 / rate : period;
}

tl::unexpected<Error> NewestFirst(const std::string& origin, const std::string& column) {
  return BadInput(Tell(
      "log '{}', column '{}': the time falls from row to row: the newest row stands first. Sort the rows by time, "
      "the oldest first",
      "Log '{}', Spalte '{}': die Zeit fällt von Zeile zu Zeile: die neueste Zeile steht zuerst. Die Zeilen nach "
      "der Zeit sortieren, die älteste zuerst",
      origin, column));
}

bool Falls(const std::vector<double>& times) {
  return times.size() > 1 && std::ranges::adjacent_find(times, std::less_equal<>()) == times.end();
}

tl::unexpected<Error> NoSamplePeriod(const std::string& origin, const std::string& column,
                                     const std::vector<double>& times, const std::string& unit) {
  if (Falls(times)) return NewestFirst(origin, column);
  return BadInput(Tell(
      "log '{}', time column '{}': the time does not increase within the first {} rows; expected times in "
      "'{}' (unit of time in [log]), or give sample_period in s there",
      "Log '{}', Zeitspalte '{}': die Zeit wächst in den ersten {} Zeilen nicht; erwartet: Zeiten in '{}' "
      "(unit von time in [log]), oder dort sample_period in s angeben",
      origin, column, times.size(), unit));
}

void TimeChecker::Check(SampleBlock& block, LogCounters& counters) {
  const std::size_t rows = block.rows();
  if (rows == 0) return;
  if (!started_) {
    started_ = true;
    reference_ = block.time[0] - sample_period_;
  }
  if (AllRegular(block)) {
    reference_ = block.time[rows - 1];
    return;
  }
  for (std::size_t row = 0; row < rows; ++row) {
    const Quality flags = FlagsOf(block.time[row]);
    if (flags == quality::kGood) continue;
    for (auto& column : block.quality) column[row] |= flags;
    for (int bit = 0; bit < 16; ++bit)
      if ((flags >> bit) & 1) counters.flagged[bit] += std::ssize(block.quality);
  }
}

bool TimeChecker::AllRegular(const SampleBlock& block) const {
  const double* time = block.time.data();
  const double first = time[0] - reference_;
  bool regular = first > 0 && first <= longest_step_;
  for (std::size_t row = 1; row < block.rows(); ++row) {
    const double step = time[row] - time[row - 1];
    regular &= (step > 0) & (step <= longest_step_);
  }
  return regular;
}

Quality TimeChecker::FlagsOf(double time) {
  const double step = time - reference_;
  Quality flags = quality::kGood;
  if (step == 0) {
    flags |= quality::kDuplicate;
  } else if (step < 0) {
    flags |= quality::kTimeBackwards;
    if (step < -kBackwardJump) flags |= quality::kClockJump;
  } else if (step > longest_step_) {
    flags |= quality::kGap;
    if (step > kForwardJump) flags |= quality::kClockJump;
  }
  if (step > 0 || (flags & quality::kClockJump) != 0) reference_ = time;
  return flags;
}

}  // namespace hydroscope
