#include "simulator/die_cushion/valve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hydroscope {
namespace {

/// Unit step response of a second-order system with damping below 1, at `t` s.
double StepResponse(double f0, double d, double t) {
  const double w0 = 2 * std::numbers::pi * f0, root = std::sqrt(1 - d * d), wd = w0 * root;
  return t <= 0 ? 0 : 1 - std::exp(-d * w0 * t) * (std::cos(wd * t) + d / root * std::sin(wd * t));
}

TEST(ServoValve, FollowsTheAnalyticStepResponseWhateverTheStep) {
  for (const double step : {10e-6, 50e-6, 1e-3}) {
    ServoValve valve(184, 0.67, 1.005, 0, step);
    for (int k = 1; k * step < 0.02; ++k)
      EXPECT_NEAR(valve.Step(0.3), 0.3 * 1.005 * StepResponse(184, 0.67, k * step), 1e-12) << "step " << step;
  }
}

TEST(ServoValve, DeadTimeShiftsTheResponse) {
  ServoValve valve(184, 0.67, 1, 2e-3, 50e-6);
  for (int k = 1; k <= 400; ++k)
    EXPECT_NEAR(valve.Step(0.5), 0.5 * StepResponse(184, 0.67, k * 50e-6 - 2e-3), 1e-12);
}

TEST(ServoValve, CriticalAndStrongDampingDoNotOvershoot) {
  for (const double damping : {1.0, 2.5}) {
    ServoValve valve(100, damping, 1, 0, 1e-4);
    double before = 0;
    for (int k = 0; k < 3000; ++k) {
      const double now = valve.Step(1);
      EXPECT_GE(now, before - 1e-9);
      before = now;
    }
    EXPECT_NEAR(before, 1, 1e-6) << "damping " << damping;
  }
}

TEST(ServoValve, StaysWhereItRests) {
  ServoValve valve(184, 0.67, 1.005, 1e-3, 50e-6);
  valve.Rest(0.2);
  for (int k = 0; k < 100; ++k) EXPECT_NEAR(valve.Step(0.2 / 1.005), 0.2, 1e-14);
}

}  // namespace
}  // namespace hydroscope
