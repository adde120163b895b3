#include "estimation/linear_form/linear_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "estimation/linear_form/noisier_copies.h"

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

/// A record of signals x and F at t = 0, 0.004, ...
template <typename Signals>
Episode RecordOf(double seconds, const Signals& signals) {
  const double period = 0.004;
  const int rows = static_cast<int>(seconds / period);
  Episode episode;
  episode.signal.resize(rows, 2);
  for (int k = 0; k < rows; ++k) {
    const auto [x, force] = signals(k * period);
    episode.time.push_back(k * period);
    episode.signal.row(k) << x, force;
  }
  return episode;
}

TEST(LinearForm, RatesKeepWhatMovesFast) {
  // Power F v = b v^2, of an oscillation of 60 rad/s: a central difference alone takes 1 % of its speed away, 2 % of b.
  LinearForm form;
  form.rates = {{"x", "v"}};
  form.parameters = {"b"};
  form.equations = {{"power", {{"b", "", "v*v"}}, "", "F"}};
  const Episode episode = RecordOf(40, [](double t) {
    const double size = 1 + 0.5 * std::sin(t), rate = 0.5 * std::cos(t);
    const double v = 0.1 * (60 * size * std::cos(60 * t) + rate * std::sin(60 * t));
    return std::pair(0.1 * size * std::sin(60 * t), 3 * v * v);
  });
  const LinearFit fit = FitLinearForm(form, MassMachine(), std::span(&episode, 1));
  ASSERT_TRUE(fit.solved()) << fit.failed;
  EXPECT_NEAR(fit.value[0], 3, 0.006);
}

TEST(LinearForm, NoiseInRegressorsDrawsNoParameterTowardsZero) {
  // Least squares alone give 2.85: the windows' speed holds noise of a fifth of what it moves.
  LinearForm form;
  form.rates = {{"x", "v"}};
  form.parameters = {"b"};
  form.equations = {{"force", {{"b", "", "v"}}, "", "F"}};
  constexpr int kRecords = 20;
  double mean = 0;
  int held = 0;
  for (unsigned seed = 1; seed <= kRecords; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    const Episode episode = RecordOf(60, [&](double t) {
      const double v = 0.3 * 2 * std::cos(2 * t) + 0.1 * 5 * std::cos(5 * t + 1);
      return std::pair(0.3 * std::sin(2 * t) + 0.1 * std::sin(5 * t + 1) + 0.05 * noise(random), 3 * v);
    });
    const LinearFit fit = FitLinearForm(form, MassMachine(), std::span(&episode, 1));
    ASSERT_TRUE(fit.solved()) << fit.failed;
    mean += fit.value[0] / kRecords;
    held += std::abs(fit.value[0] - 3) < 2.02 * fit.std[0];
  }
  EXPECT_NEAR(mean, 3, 0.05);
  EXPECT_GE(held, 16);
}

/// Fits of a form, one to the record of each of `records` seeds.
template <typename Record>
std::vector<LinearFit> FitsOf(const LinearForm& form, int records, const Record& record) {
  std::vector<LinearFit> fits;
  for (unsigned seed = 1; seed <= static_cast<unsigned>(records); ++seed) {
    const Episode episode = record(seed);
    fits.push_back(FitLinearForm(form, MassMachine(), std::span(&episode, 1)));
  }
  return fits;
}

LinearForm EdgeForm(const char* opening) {
  LinearForm form;
  form.parameters = {"c"};
  form.equations = {{"flow", {{"c", "", opening}}, "", "F"}};
  return form;
}

TEST(LinearForm, WhatASignalDoesFromRowToRowIsNotTakenForNoise) {
  // x jitters by 0.2 and is read to 0.001, as a spool does that follows noisy readings; the balance holds to that.
  const auto fits = FitsOf(EdgeForm("max(x, 0)"), 10, [](unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    return RecordOf(40, [&](double t) {
      const double x = std::sin(2 * t) + 0.2 * noise(random);
      return std::pair(x + 0.001 * noise(random), 3 * std::max(x, 0.0));
    });
  });
  for (const LinearFit& fit : fits) {
    ASSERT_TRUE(fit.solved()) << fit.failed;
    EXPECT_NEAR(fit.value[0], 3, 0.001);
  }
}

TEST(LinearForm, IntervalsHoldWhereFewPiecesTellOfAParameter) {
  // x is above 0.95 in three short parts of the record.
  constexpr int kRecords = 200;
  const auto fits = FitsOf(EdgeForm("max(x - 0.95, 0)"), kRecords, [](unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    return RecordOf(40, [&](double t) {
      const double x = std::sin(2 * std::numbers::pi * 3 * t / 40);
      return std::pair(x, 3 * std::max(x - 0.95, 0.0) + noise(random));
    });
  });
  int held = 0;
  for (const LinearFit& fit : fits) {
    ASSERT_TRUE(fit.solved()) << fit.failed;
    held += std::abs(fit.value[0] - 3) < 1.96 * fit.std[0];
  }
  EXPECT_GE(held, 0.92 * kRecords);
}

TEST(LinearForm, NoiseOfTheSpeedDoesNotTurnDryFrictionAbout) {
  // As near to the turning speed as the arm's angles are read: 1 mm/s and 5 um from row to row.
  LinearForm form;
  form.rates = {{"x", "v"}};
  form.parameters = {"b", "c"};
  form.equations = {{"force", {{"b", "", "v"}, {"c", "", "tanh(v/0.001)"}}, "", "F"}};
  constexpr int kRecords = 40;
  const auto fits = FitsOf(form, kRecords, [](unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    return RecordOf(40, [&](double t) {
      const double v = 0.02 * std::cos(2 * t);
      return std::pair(0.01 * std::sin(2 * t) + 5e-6 * noise(random),
                       3 * v + 0.1 * std::tanh(v / 0.001) + 0.01 * noise(random));
    });
  });
  double mean = 0;
  for (const LinearFit& fit : fits) {
    ASSERT_TRUE(fit.solved()) << fit.failed;
    mean += fit.value[1] / kRecords;
  }
  EXPECT_NEAR(mean, 0.1, 0.0003);
}

TEST(NoisierCopies, NoiseIsFoundBesideMotionAndDoubledInEnergy) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  const Episode episode =
      RecordOf(40, [&](double t) { return std::pair(std::sin(30 * t) + 0.01 * noise(random), 0.0); });
  const Eigen::VectorXd found = WhiteNoiseOfSignals(std::span(&episode, 1));
  EXPECT_NEAR(found[0], 0.01, 3e-4);
  EXPECT_EQ(found[1], 0);
  const auto copies = NoisierCopies(std::span(&episode, 1), found, 1, 1);
  ASSERT_EQ(copies.size(), 2u);
  const Eigen::VectorXd sum = copies[0].front().signal.col(0) + copies[1].front().signal.col(0);
  EXPECT_LT((sum - 2 * episode.signal.col(0)).cwiseAbs().maxCoeff(), 1e-12)
      << "one draw, added and taken away";
  EXPECT_NEAR(WhiteNoiseOfSignals(copies[0])[0], 0.01 * std::sqrt(2), 5e-4);
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
