#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr char kTank[] = R"toml([machine]
name = "tank"
[log]
hold = "zero"
time = { column = "t", unit = "s" }
[signals]
u = { column = "u", unit = "V" }
level_1 = { column = "y_1", unit = "V" }
level_2 = { column = "y_2", unit = "V" }
[states]
h_1 = { ddt = "pump*u - k1*sqrt(max(h_1, 0))", min = 0 }
h_2 = { ddt = "k1*sqrt(max(h_1, 0)) - k2*sqrt(max(h_2, 0))", min = 0 }
[outputs]
level_1 = "h_1"
level_2 = "h_2"
[parameters]
k1 = { start = 0.1, min = 0.01, max = 2 }
k2 = { start = 0.1, min = 0.01, max = 2 }
pump = { start = 0.1, min = 0.01, max = 2 }
[episodes]
seconds = 200
)toml";

/// Two tanks in a row of which the second's outlet clogs from episode 120 on, by a share of its size per episode.
class StatesDrift : public CommandLine {
 protected:
  static constexpr int kEpisodes = 200, kChange = 120, kRows = 200;
  static constexpr double kPump = 0.2, kFirst = 0.3, kSecond = 0.3;

  static double Second(int episode, double rate) {
    return kSecond * (1 - rate * std::max(0, episode - kChange));
  }
  using Levels = std::array<double, 2>;
  static Levels RateOf(const Levels& h, double voltage, double second) {
    const double q1 = kFirst * std::sqrt(std::max(0.0, h[0])), q2 = second * std::sqrt(std::max(0.0, h[1]));
    return {kPump * voltage - q1, q1 - q2};
  }
  /// Runge and Kutta's method of order 4 with steps of a quarter of a row.
  static Levels After(Levels h, double voltage, double second) {
    constexpr double kStep = 0.25;
    const auto moved = [&](const Levels& rate, double share) {
      return Levels{h[0] + share * kStep * rate[0], h[1] + share * kStep * rate[1]};
    };
    for (int step = 0; step < 4; ++step) {
      const Levels a = RateOf(h, voltage, second), b = RateOf(moved(a, 0.5), voltage, second),
                   c = RateOf(moved(b, 0.5), voltage, second), d = RateOf(moved(c, 1), voltage, second);
      for (std::size_t k = 0; k < 2; ++k) h[k] += kStep / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
    }
    return h;
  }
  std::string Log(double rate) {
    std::string text = "t,u,y_1,y_2\n";
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0, 0.02);
    std::uniform_int_distribution<int> level(100, 500);
    double u = 3;
    Levels h = {4, 4};
    for (int row = 0; row < kEpisodes * kRows; ++row) {
      if (row % 20 == 0) u = level(random) / 100.0;
      text += fmt::format("{},{:.2f},{:.5f},{:.5f}\n", row, u, h[0] + noise(random), h[1] + noise(random));
      h = After(h, u, Second(row / kRows, rate));
    }
    WriteText(File("tank.csv"), text);
    return File("tank.csv");
  }
  void Replay(double rate) {
    WriteText(File("tank.toml"), kTank);
    const auto run = Run({"replay", Log(rate), "-m", File("tank.toml"), "--db", File("tank.db"), "--report",
                          File("tank.html")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
};

TEST_F(StatesDrift, IsFollowedAndNamed) {
  Replay(0.002);
  const std::string alarms = Run({"alarms", "--db", File("tank.db"), "list"}).out;
  EXPECT_THAT(alarms, HasSubstr("unnamed_change_k2"));
  EXPECT_THAT(alarms, Not(HasSubstr("unnamed_change_k1")));
  EXPECT_THAT(alarms, Not(HasSubstr("unnamed_change_pump")));
  EXPECT_THAT(ReadText(File("tank.html")), HasSubstr("k2"));
  const auto trends = nlohmann::json::parse(Run({"trends", "--db", File("tank.db"), "--json", "-"}).out);
  std::array<int, 3> inside{}, judged{};
  for (const auto& point : trends.at("points")) {
    const int episode = point.at("stroke").get<int>();
    if (episode < 20) continue;
    const std::string name = point.at("parameter").get<std::string>();
    const std::size_t at = name == "k1" ? 0 : name == "k2" ? 1 : 2;
    const double truth = at == 0 ? kFirst : at == 1 ? Second(episode, 0.002) : kPump;
    inside[at] += std::abs(point.at("value").get<double>() - truth) < 1.96 * point.at("std").get<double>();
    ++judged[at];
  }
  for (std::size_t at = 0; at < 3; ++at) {
    EXPECT_EQ(judged[at], kEpisodes - 20);
    EXPECT_GT(inside[at], 0.85 * judged[at]) << "parameter " << at;
  }
}

TEST_F(StatesDrift, IsNotSeenInAHealthyMachine) {
  Replay(0);
  EXPECT_THAT(Run({"alarms", "--db", File("tank.db"), "list"}).out, HasSubstr("no alarm stands"));
}

}  // namespace
}  // namespace hydroscope::command_line_test
