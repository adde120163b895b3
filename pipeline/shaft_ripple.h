#pragma once

#include <array>
#include <complex>
#include <vector>

namespace hydroscope {

/// What of a signal repeats with a shaft. Its shape over the angle is the median of all revolutions, so that steps of the signal
/// itself do not bend it; its size is found four times in each revolution from the faster orders, where such steps hardly show
/// (order tracking, Fyfe and Munck, Mechanical Systems and Signal Processing 11, 1997). Nothing where too few revolutions repeat.
class ShaftRipple {
 public:
  static constexpr int kOrders = 12;  ///< of the shaft, beyond the pistons of any usual pump

  /// `turns`: of the shaft at each reading, from 0 on; a revolution with a reading that is not finite says nothing.
  ShaftRipple(const std::vector<double>& turns, const std::vector<double>& readings);

  bool empty() const { return sizes_.empty(); }
  double At(double turn) const;
  /// The orders 1 to 3, so that lines between `points` values per revolution hold all of them.
  double SlowAt(double turn, int points) const;

 private:
  static constexpr int kSizesPerTurn = 4;
  /// Orders beyond the first `slowest`, at size 1.
  double ShapeAt(double turn, int slowest) const;
  double SizeAt(double turn) const;
  std::vector<double> SizesWithin(const std::vector<double>& turns,
                                  const std::vector<double>& readings) const;

  std::array<std::complex<double>, kOrders> shape_{};
  std::vector<double> sizes_;  ///< about 1, the first in the middle of the first revolution
};

}  // namespace hydroscope
