#pragma once

#include <cstdint>

namespace hydroscope::drift {

/// What counts as a drift of one quantity, SI.
struct DriftSize {
  double smallest = 0;        ///< worth finding
  double alarm = 0;           ///< worth stopping for
  bool only_upwards = false;  ///< leakage cannot be negative
};

/// Two-sided cumulative-sum test (Page 1954) on standardised deviations of strokes, for the hypotheses
///   healthy: |shift| <= tolerance,   drifted: |shift| >= tolerance + something,
/// with tolerance = half of the smallest drift worth finding + twice the std of the reference itself. Each
/// stroke adds its log-likelihood ratio m (z - t) - m^2/2 for a shift of m standard deviations, m =
/// smallest/std but at most 2, z clipped to +-4: one bad stroke adds 6 at most, far below the threshold of 20 (mean time between
/// false alarms above e^20 strokes for independent normal deviations, Lorden 1971).
class CumulativeSum {
 public:
  /// Takes a stroke's deviation in; `std` its sampling error, `doubt` the std of the reference, SI.
  void Add(std::int64_t sequence, double deviation, double std, double doubt, const DriftSize& size);
  /// +1 or -1 if the test says drifted, 0 else.
  int Direction() const;
  /// The last stroke before the sum of the drifting side (or, if none drifts, the larger one) began to rise.
  std::int64_t last_before() const { return up_ >= down_ ? up_from_ : down_from_; }
  double statistic() const { return up_ >= down_ ? up_ : -down_; }
  void Reset(std::int64_t sequence);

 private:
  double up_ = 0, down_ = 0;
  std::int64_t up_from_ = -1, down_from_ = -1;
};

}  // namespace hydroscope::drift
