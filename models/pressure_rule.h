#pragma once

#include <string>

namespace hydroscope {

/// What physics asks of two pressures of a machine, by which their columns are told from one another.
struct PressureRule {
  enum class Law {
    /// `lower` stands above `higher` for moments at most.
    kBelow,
    /// `higher` fills chamber `lower` while `driven_by` is less than -`open`: then `lower` stands below it but for moments.
    kFilled,
    /// More than `open` of `driven_by` lets oil out of chamber `higher`, less than -`open` into it: its pressure rises as its oil leaves,
    /// being pressed out, and `lower` need not move.
    kPressedOut,
  };
  std::string lower, higher;
  Law law = Law::kBelow;
  std::string driven_by = {};  ///< a signal, SI
  double open = 0;

  /// Of all rows: more are no moments.
  static constexpr double kNearlyAlways = 0.95;
};

}  // namespace hydroscope
