#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/command_line_fixture.h"
#include "tests/live_fixture.h"

namespace hydroscope::command_line_test {

/// Two tanks in a row of which the second's outlet clogs from an episode on, by a share of its size per episode.
class Tanks : public CommandLine {
 protected:
  static constexpr double kPump = 0.2, kFirst = 0.3, kSecond = 0.3;

  int episodes_ = 200, change_ = 120, rows_ = 200;  ///< rows of an episode
  double period_ = 1;                               ///< s between rows, and the unit of time of everything
  double noise_ = 0.02;                             ///< V, of the levels
  double overflow_ = 0;  ///< 1/s, of what stands above 5 in the first: not in the machine file

  double Second(int episode, double rate) const {
    return kSecond * (1 - rate * std::max(0, episode - change_));
  }
  std::string MachineText(const std::string& name) const {
    const auto parameter = [&](const char* id, double start) {
      return fmt::format("{} = {{ start = {}, min = {}, max = {} }}\n", id, start / period_,
                         start / 10 / period_, start * 20 / period_);
    };
    return fmt::format(R"toml([machine]
name = "{}"
[log]
hold = "zero"
time = {{ column = "t", unit = "s" }}
[signals]
u = {{ column = "u", dds = "u", unit = "V" }}
level_1 = {{ column = "y_1", dds = "level_1", unit = "V" }}
level_2 = {{ column = "y_2", dds = "level_2", unit = "V" }}
[states]
h_1 = {{ ddt = "pump*u - k1*sqrt(max(h_1, 0))", min = 0 }}
h_2 = {{ ddt = "k1*sqrt(max(h_1, 0)) - k2*sqrt(max(h_2, 0))", min = 0 }}
[outputs]
level_1 = "h_1"
level_2 = "h_2"
[episodes]
seconds = {}
[parameters]
)toml",
                       name, rows_ * period_) +
           parameter("k1", 0.1) + parameter("k2", 0.1) + parameter("pump", 0.1) +
           fmt::format("[live]\ngrid_period = {}\n[live.dds]\ndomain = {}\ninterfaces = [\"127.0.0.1\"]\n",
                       period_, OwnDomain());
  }
  std::string Log(double rate) {
    std::string text = "t,u,y_1,y_2\n";
    std::mt19937 random(4);
    std::normal_distribution<double> noise(0, noise_);
    std::uniform_int_distribution<int> level(100, 500);
    double u = 3;
    Levels h = {4, 4};
    for (int row = 0; row < episodes_ * rows_; ++row) {
      if (row % 20 == 0) u = level(random) / 100.0;
      text += fmt::format("{:.6g},{:.2f},{:.5f},{:.5f}\n", row * period_, u, h[0] + noise(random),
                          h[1] + noise(random));
      h = After(h, u, Second(row / rows_, rate));
    }
    WriteText(File("tank.csv"), text);
    return File("tank.csv");
  }
  /// Of k1, k2, pump: the share of the stored episodes from 20 on whose 95 % interval holds the truth.
  std::array<double, 3> Coverage(double rate) {
    const Ran ran = Run({"trends", "--db", File("tank.db"), "--json", "-"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    const auto trends = ran.Json();
    std::array<int, 3> inside{}, judged{};
    for (const auto& point : trends.at("points")) {
      const int episode = point.at("stroke").get<int>();
      if (episode < 20) continue;
      const std::string name = point.at("parameter").get<std::string>();
      const std::size_t at = name == "k1" ? 0 : name == "k2" ? 1 : 2;
      const double truth = (at == 0 ? kFirst : at == 1 ? Second(episode, rate) : kPump) / period_;
      inside[at] += std::abs(point.at("value").get<double>() - truth) < 1.96 * point.at("std").get<double>();
      ++judged[at];
    }
    std::array<double, 3> share{};
    for (std::size_t at = 0; at < 3; ++at) {
      EXPECT_GE(judged[at], episodes_ - 22);
      share[at] = judged[at] == 0 ? 0 : static_cast<double>(inside[at]) / judged[at];
    }
    return share;
  }

 private:
  using Levels = std::array<double, 2>;
  Levels RateOf(const Levels& h, double voltage, double second) const {
    const double q1 = kFirst * std::sqrt(std::max(0.0, h[0])), q2 = second * std::sqrt(std::max(0.0, h[1]));
    return {kPump * voltage - q1 - overflow_ * std::max(0.0, h[0] - 5), q1 - q2};
  }
  /// Runge and Kutta's method of order 4 with steps of a quarter of a row.
  Levels After(Levels h, double voltage, double second) const {
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
};

}  // namespace hydroscope::command_line_test
