#pragma once

#include <string>

namespace hydroscope {

/// What physics asks of two pressures of a machine, by which their columns are told from one another.
struct PressureRule {
  enum class Law {
    kBelow,       ///< `lower` stands above `higher` for moments at most
    kFilled,      ///< ... while `driven_by`, less than -`open`, lets oil from `higher` into `lower`: nor do the two stand alike
    kPressedOut,  ///< `driven_by` beyond `open` lets oil out of `higher`, which is pressed out, beyond -`open` into it: `higher` is the
                  ///< chamber whose pressure rises as its oil leaves, and `lower` need not move
  };
  std::string lower, higher;
  Law law = Law::kBelow;
  std::string driven_by = {};  ///< a signal, SI
  double open = 0;

  /// Of all rows: more are no moments.
  static constexpr double kNearlyAlways = 0.95;
};

}  // namespace hydroscope
