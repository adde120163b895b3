#pragma once

#include <array>

#include "simulator/manipulator/machine.h"

namespace hydroscope {

/// What the manipulator remembers.
struct ManipulatorState {
  std::array<double, kJoints> q{}, w{};      ///< rad, rad/s, joint angles and speeds
  std::array<double, kJoints> p_1{}, p_2{};  ///< Pa, piston and rod side
  std::array<double, kJoints> spool{}, v{};  ///< 1, 1/s
  std::array<double, kJoints> rod{};         ///< m, piston against the link, within the play
  double p_s = 0;                            ///< Pa, supply
};

/// Joint torques for a motion by Newton's and Euler's equations, body by body from the base to the tip and back
/// (Luh, Walker and Paul 1980), gravity included: N m.
std::array<double, kJoints> InverseDynamics(const ManipulatorTruth& truth, const ManipulatorState& state,
                                            const std::array<double, kJoints>& acceleration);

/// Force of the rod on the link that it drives, N, along its extension.
double RodForce(const CylinderTruth& cylinder, const ManipulatorState& state, int joint);

/// The machine itself: rigid bodies, cylinders with two chambers, valves with four edges, supply. Integrated by Runge
/// and Kutta's method of order 4 with a fixed step.
class ManipulatorPlant {
 public:
  /// At rest at these angles, the chambers holding the load.
  ManipulatorPlant(const ManipulatorTruth& truth, const std::array<double, kJoints>& q);

  /// Runs for `seconds` with the commands of the valves held, -1 ... 1.
  void Run(const std::array<double, kJoints>& command, double seconds);

  const ManipulatorState& state() const { return state_; }

 private:
  ManipulatorState Rate(const ManipulatorState& state, const std::array<double, kJoints>& command) const;

  ManipulatorTruth truth_;
  ManipulatorState state_;
};

}  // namespace hydroscope
