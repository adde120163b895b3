#include "diagnosis/states/other_causes/reversed_signal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/states/other_causes/lag_fixture.h"
#include "simulator/flexible_axis/log.h"
#include "simulator/manipulator/manipulator.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

Machine Shipped(const std::string& name) {
  const auto machine = LoadMachine(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/" + name);
  EXPECT_TRUE(machine) << machine.error().text;
  return machine.value_or(Machine{});
}

/// What is told of an episode with one of its columns reversed ("" = none).
std::string ToldOf(const Machine& machine, Episode episode, const std::string& reversed = "") {
  if (!reversed.empty()) episode.signal.col(machine.SignalIndex(reversed)) *= -1;
  return ReversedSignalIn(machine, std::span(&episode, 1)).english;
}

class AxisSigns : public testing::Test {
 protected:
  static Episode Log(double late = 0, double spring_loss = 0) {
    FlexibleAxisOptions o;
    o.manoeuvre = AxisManoeuvre::kStaircase;
    o.sensors.filter = late;
    o.faults.spring_loss = spring_loss;
    const FlexibleAxisLog log = SimulateFlexibleAxis(o);
    const Machine machine = Shipped("flexible_axis.toml");
    Episode episode;
    episode.time = log.t;
    episode.signal.resize(episode.rows(), 6);
    const auto take = [&](const char* signal, const std::vector<double>& column) {
      episode.signal.col(machine.SignalIndex(signal)) =
          Eigen::Map<const Eigen::VectorXd>(column.data(), episode.rows());
    };
    take("U", log.U);
    take("position", log.x_p);
    take("load_position", log.x_l);
    take("acceleration", log.a_p);
    take("pressure_1", log.p_1);
    take("pressure_2", log.p_2);
    return episode;
  }
  const Machine machine_ = Shipped("flexible_axis.toml");
};

TEST_F(AxisSigns, AnAccelerationAgainstThePositionIsTold) {
  EXPECT_THAT(
      ToldOf(machine_, Log(), "acceleration"),
      HasSubstr("acceleration (column a_p) has the opposite sign of the second derivative of position"));
}

TEST_F(AxisSigns, ACommandAgainstTheMotionIsTold) {
  EXPECT_THAT(ToldOf(machine_, Log(), "U"), HasSubstr("U (column U) counts the other way round"));
}

TEST_F(AxisSigns, NoneIsToldOfWhatIsRight) {
  EXPECT_EQ(ToldOf(machine_, Log()), "");
  EXPECT_EQ(ToldOf(machine_, Log(20)), "") << "sensors that lag";
  EXPECT_EQ(ToldOf(machine_, Log(0, 0.5)), "") << "a law that is missing";
}

TEST(ReversedSignal, OfTwoSensorsTiedByTimeIsToldAtAnyScale) {
  const auto machine = ParseMachine(R"toml(
[signals]
F = { column = "F", unit = "N" }
x = { column = "x", unit = "m" }
s = { column = "s", unit = "m/s" }
[states]
X = { ddt = "V" }
V = { ddt = "F/m" }
[outputs]
x = "X"
s = "V"
[parameters]
m = { start = 1, min = 0.1, max = 10 }
)toml",
                                    "mass");
  ASSERT_TRUE(machine) << machine.error().text;
  const auto model = BuildStateModel(*machine, {});
  ASSERT_TRUE(model);
  EXPECT_THAT(TiedSignalsOf(**model), testing::ElementsAre(TiedSignals{1, 2, 1}));
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  Episode episode;
  episode.signal.resize(1000, 3);
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.01 * k;
    episode.time.push_back(t);
    episode.signal.row(k) << -std::sin(t) - std::sin(2.7 * t),
        std::sin(t) + std::sin(2.7 * t) / 7.29 + t + 1e-3 * noise(random),
        std::cos(t) + std::cos(2.7 * t) / 2.7 + 1 + 1e-2 * noise(random);
  }
  EXPECT_EQ(ToldOf(*machine, episode), "");
  EXPECT_THAT(ToldOf(*machine, episode, "s"), HasSubstr("opposite sign of the derivative of x (column x)"));
}

TEST(ReversedSignal, TheInputOfALagIsTold) {
  const Machine machine = LagMachine("hold = \"smooth\"\n");
  EXPECT_EQ(ToldOf(machine, LagEpisode({Filtered})), "");
  EXPECT_EQ(ToldOf(machine, LagEpisode({Filtered, Hardening})), "") << "a law that is missing";
  EXPECT_THAT(ToldOf(machine, LagEpisode({Filtered}), "u"), HasSubstr("u (column u) counts the other way"));
}

TEST(ReversedSignal, AStartThatLeadsAstrayIsNone) {
  const auto machine = ParseMachine(R"toml(
[log]
hold = "smooth"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "-k*x + cos(a)*u", initial = "estimate" }
[outputs]
y = "x"
[parameters]
k = { start = 3, min = 0.1, max = 30 }
a = { start = 3.2, min = 0, max = 4.5 }
)toml",
                                    "lag");
  ASSERT_TRUE(machine) << machine.error().text;
  EXPECT_EQ(ToldOf(*machine, LagEpisode({Filtered})), "");
}

TEST(ReversedSignal, ASpoolOfAnArmIsToldByItsBalances) {
  ManipulatorOptions o;
  o.seconds = 20;
  const ManipulatorLog log = SimulateManipulator(o);
  const Machine machine = Shipped("manipulator.toml");
  Episode episode;
  episode.signal.resize(static_cast<Eigen::Index>(log.rows.size()), 9);
  const auto at = [&](const std::string& name, double value) {
    episode.signal(static_cast<Eigen::Index>(episode.time.size()), machine.SignalIndex(name)) = value;
  };
  for (const ManipulatorRow& row : log.rows) {
    const ManipulatorReadings& r = row.readings;
    at("p_s", r.p_s);
    for (const std::size_t i : {0, 1}) {
      const std::string joint = std::to_string(i + 1);
      at("q_" + joint, r.q[i]);
      at("p_" + joint + "1", r.p_1[i]);
      at("p_" + joint + "2", r.p_2[i]);
      at("y_" + joint, r.spool[i]);
    }
    episode.time.push_back(row.time);
  }
  EXPECT_EQ(ToldOf(machine, episode), "");
  EXPECT_THAT(ToldOf(machine, episode, "y_2"), HasSubstr("y_2 (column y_2) counts the other way round"));
}

}  // namespace
}  // namespace hydroscope
