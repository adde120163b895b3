#include "estimation/linear_form/linear_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A mass with friction under a known force, position and force measured: m dv/dt + b v = F. `same` acts like m.
LinearForm MassForm() {
  LinearForm form;
  form.rates = {{"x", "v"}};
  form.parameters = {"m", "b", "same"};
  form.equations = {{"force", {{"m", "v", ""}, {"b", "", "v"}, {"same", "2*v", ""}}, "", "F"}};
  return form;
}

Machine MassMachine() {
  Machine machine;
  for (const char* name : {"x", "F"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    signal.unit = "1";
    machine.signals.push_back(signal);
  }
  return machine;
}

/// x(t) of two sines, F from it in closed form.
Episode MassRecord(double mass, double friction, double seconds, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  const double period = 0.004;
  const int rows = static_cast<int>(seconds / period);
  Episode episode;
  episode.signal.resize(rows, 2);
  for (int k = 0; k < rows; ++k) {
    const double t = k * period;
    const double v = 0.3 * 2 * std::cos(2 * t) + 0.1 * 5 * std::cos(5 * t + 1);
    const double a = -0.3 * 4 * std::sin(2 * t) - 0.1 * 25 * std::sin(5 * t + 1);
    episode.time.push_back(t);
    episode.signal(k, 0) = 0.3 * std::sin(2 * t) + 0.1 * std::sin(5 * t + 1) + 1e-5 * noise(random);
    episode.signal(k, 1) = mass * a + friction * v + 0.5 * noise(random);
  }
  return episode;
}

TEST(LinearForm, FindsParametersInsideTheirIntervals) {
  int held = 0, all = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Episode episode = MassRecord(5, 3, 40, seed);
    const LinearFit fit = FitLinearForm(MassForm(), MassMachine(), std::span(&episode, 1));
    ASSERT_TRUE(fit.solved()) << fit.failed;
    EXPECT_THAT(fit.parameters, ElementsAre("m", "b"));
    EXPECT_EQ(BaseParameterText(MassForm(), fit.base, 0), "m + 2 same");
    EXPECT_NEAR(fit.value[0], 5, 0.02);
    for (const auto& [k, truth] : {std::pair{0, 5.0}, std::pair{1, 3.0}}) {
      held += std::abs(fit.value[k] - truth) < 2.02 * fit.std[k];
      ++all;
    }
  }
  EXPECT_GE(held, 0.8 * all);
}

TEST(LinearForm, SaysWhenARecordIsTooShort) {
  const Episode episode = MassRecord(5, 3, 2, 1);
  EXPECT_THAT(FitLinearForm(MassForm(), MassMachine(), std::span(&episode, 1)).failed,
              HasSubstr("record longer"));
}

TEST(LinearForm, LeavesOutWindowsWithoutAReading) {
  Episode episode = MassRecord(5, 3, 40, 1);
  const int all = FitLinearForm(MassForm(), MassMachine(), std::span(&episode, 1)).windows;
  episode.signal(2000, 1) = std::nan("");
  const LinearFit fit = FitLinearForm(MassForm(), MassMachine(), std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed;
  EXPECT_LT(fit.windows, all);
  EXPECT_NEAR(fit.value[0], 5, 0.02);
}

}  // namespace
}  // namespace hydroscope
