#include "simulator/die_cushion/valve.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace hydroscope {

ServoValve::ServoValve(double f0, double damping, double gain, double dead_time, double step) : gain_(gain) {
  // With s1, s2 the roots of s^2 + 2 D w0 s + w0^2: exp(A h) = (exp(s1 h)(A - s2) - exp(s2 h)(A - s1)) / (s1
  // - s2).
  const double w0 = 2 * std::numbers::pi * f0;
  const double apart = damping == 1 ? 1e-9 : 0.0;  // equal roots would divide by zero
  const std::complex<double> root = w0 * std::sqrt(std::complex<double>(damping * damping - 1 + apart));
  const std::complex<double> s1 = -damping * w0 + root, s2 = -damping * w0 - root;
  const std::complex<double> e1 = std::exp(s1 * step) / (s1 - s2), e2 = std::exp(s2 * step) / (s1 - s2);
  a11_ = (-e1 * s2 + e2 * s1).real();
  a12_ = (e1 - e2).real();
  a21_ = -w0 * w0 * a12_;
  a22_ = (e1 * (-2 * damping * w0 - s2) - e2 * (-2 * damping * w0 - s1)).real();
  delay_.assign(static_cast<std::size_t>(std::lround(dead_time / step)), 0.0);
}

void ServoValve::Rest(double position) {
  position_ = position;
  speed_ = 0;
  for (double& command : delay_) command = position / gain_;
}

double ServoValve::Step(double command) {
  if (!delay_.empty()) {
    std::swap(command, delay_[next_]);
    next_ = next_ + 1 == delay_.size() ? 0 : next_ + 1;
  }
  const double target = gain_ * command, offset = position_ - target;
  position_ = target + a11_ * offset + a12_ * speed_;
  speed_ = a21_ * offset + a22_ * speed_;
  return position_;
}

}  // namespace hydroscope
