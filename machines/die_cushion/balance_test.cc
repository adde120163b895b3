#include "machines/die_cushion/balance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

Machine TestMachine(double area_std = 0) {
  Machine machine;
  machine.name = "test";
  for (const char* name : {"p_A", "z", "y_v", "p_B", "p_0", "T_oil"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    machine.signals.push_back(signal);
  }
  machine.geometry["A_A"] = {0.0125, area_std};
  machine.geometry["dp_nom"] = {35e5, 0};
  return machine;
}

Eigen::VectorXd ThetaOf(double bulk, double dead, double flow, double null) {
  const double gain = flow / std::sqrt(35e5);
  return Eigen::Vector4d(-gain, -dead / bulk, -0.0125 / bulk, gain * null);
}

TEST(DieCushion, TheSpoolIsShownInTheUnitThatCheckShowsItIn) {
  for (const auto& [unit, factor] : {std::pair("1", 1.0), std::pair("%", 100.0)}) {
    Machine machine = TestMachine();
    machine.signals[2].unit = unit;
    const auto model = *BuildModel(machine);
    const auto spool = std::ranges::find(model->shown, "y_v", [&](const auto& shown) {
      return model->channel_names[static_cast<std::size_t>(shown.channel)];
    });
    ASSERT_NE(spool, model->shown.end());
    EXPECT_EQ(spool->display, unit);
    EXPECT_EQ(spool->factor, factor);
  }
}

TEST(DieCushion, PhysicalParametersComeBackFromTheRegressionParameters) {
  const auto model = *BuildModel(TestMachine());
  const auto derived = model->derive(ThetaOf(1.21e9, 1.65e-3, 1.7e-3, 0.008));
  ASSERT_EQ(derived.size(), 4u);
  const std::pair<const char*, double> expected[] = {
      {"K", 1.21e9}, {"V0", 1.65e-3}, {"Q_vn", 1.7e-3}, {"y_0", 0.008}};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(derived[i].name, expected[i].first);
    EXPECT_NEAR(derived[i].value / expected[i].second, 1.0, 1e-12);
    EXPECT_TRUE(derived[i].admissible);
    EXPECT_EQ(derived[i].geometry_std, 0.0);
  }
}

TEST(DieCushion, GradientsAgreeWithFiniteDifferences) {
  const auto model = *BuildModel(TestMachine());
  const Eigen::VectorXd theta = ThetaOf(1.21e9, 1.65e-3, 1.7e-3, 0.008);
  const auto derived = model->derive(theta);
  for (int j = 0; j < 4; ++j) {
    const double step = 1e-6 * std::abs(theta[j]);
    const Eigen::VectorXd up = theta + step * Eigen::VectorXd::Unit(4, j),
                          down = theta - step * Eigen::VectorXd::Unit(4, j);
    const auto above = model->derive(up), below = model->derive(down);
    for (int i = 0; i < 4; ++i) {
      const double slope = (above[i].value - below[i].value) / (2 * step);
      const double size = std::abs(derived[i].value / theta[j]);
      EXPECT_NEAR(derived[i].gradient[j] / size, slope / size, 1e-6)
          << derived[i].name << " by theta" << j + 1;
    }
  }
}

TEST(DieCushion, UncertaintyOfTheAreaAgreesWithFiniteDifferences) {
  const double std = 1e-4;
  const auto model = *BuildModel(TestMachine(std));
  const Eigen::VectorXd theta = ThetaOf(1.21e9, 1.65e-3, 1.7e-3, 0.008);
  const auto derived = model->derive(theta);
  // The balance is known per piston area: with another area every theta grows in proportion.
  Machine larger = TestMachine();
  larger.geometry["A_A"].value += std;
  const Eigen::VectorXd grown = theta * (0.0125 + std) / 0.0125;
  const auto other = (*BuildModel(larger))->derive(grown);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(derived[i].geometry_std, std::abs(other[i].value - derived[i].value),
                1e-9 * std::abs(derived[i].value))
        << derived[i].name;
}

TEST(DieCushion, ValuesAgainstPhysicsAreGivenButMarked) {
  const auto model = *BuildModel(TestMachine());
  EXPECT_FALSE(model->derive(ThetaOf(-1e9, 1.65e-3, 1.7e-3, 0.008))[0].admissible);
  EXPECT_FALSE(model->derive(ThetaOf(9e9, 1.65e-3, 1.7e-3, 0.008))[0].admissible);
  EXPECT_FALSE(model->derive(ThetaOf(1e9, -1e-3, 1.7e-3, 0.008))[1].admissible);
  EXPECT_FALSE(model->derive(ThetaOf(1e9, 1e-3, -1.7e-3, 0.008))[2].admissible);
  EXPECT_FALSE(model->derive(ThetaOf(1e9, 1e-3, 1.7e-3, 0.5))[3].admissible);
  for (const auto& p : model->derive(Eigen::VectorXd::Zero(4))) EXPECT_FALSE(p.admissible) << p.name;
}

TEST(DieCushion, WhatIsMissingInTheMachineIsNamed) {
  Machine no_area = TestMachine(), no_spool = TestMachine(), unknown = TestMachine();
  no_area.geometry.erase("A_A");
  no_spool.signals.erase(no_spool.signals.begin() + 2);
  unknown.model = "winch";
  EXPECT_THAT(BuildModel(no_area).error().text, testing::HasSubstr("A_A"));
  EXPECT_THAT(BuildModel(no_spool).error().text, testing::HasSubstr("y_v"));
  EXPECT_THAT(BuildModel(unknown).error().text, testing::HasSubstr("winch"));
}

TEST(DieCushion, EffectsWhoseSignalsAreNotMeasuredAreNotOffered) {
  Machine without = TestMachine();
  without.signals.erase(without.signals.begin() + 3);  // p_B
  const auto all = *BuildModel(TestMachine()), fewer = *BuildModel(without);
  const auto has = [](const ModelStructure& model, const std::string& id) {
    return std::any_of(model.effects.begin(), model.effects.end(),
                       [&](const auto& e) { return e->id == id; });
  };
  EXPECT_TRUE(has(*all, "internal_leakage"));
  EXPECT_FALSE(has(*fewer, "internal_leakage"));
  EXPECT_TRUE(has(*fewer, "external_leakage"));
  EXPECT_EQ(all->effects.size(), 18u);
}

}  // namespace
}  // namespace hydroscope
