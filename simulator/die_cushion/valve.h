#pragma once

#include <cstddef>
#include <vector>

namespace hydroscope {

/// Spool of a servo valve: y'' / w0^2 + 2 D y' / w0 + y = K_v u(t - T_dead), solved exactly for a command
/// that is constant over each step (matrix exponential), so the result does not depend on the step.
class ServoValve {
 public:
  /// `f0` Hz, 0 < `damping` < 1 or more, `step` s, `dead_time` s (rounded to whole steps).
  ServoValve(double f0, double damping, double gain, double dead_time, double step);

  /// Sets the spool at rest at `position` with the command that holds it there.
  void Rest(double position);
  /// One step under `command` (1 = full scale); returns the position at its end.
  double Step(double command);
  double position() const { return position_; }

 private:
  double gain_;
  double a11_, a12_, a21_, a22_;  // transition of (position - target, speed)
  double position_ = 0, speed_ = 0;
  std::vector<double> delay_;  // ring of commands on their way
  std::size_t next_ = 0;
};

}  // namespace hydroscope
