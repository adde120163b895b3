#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "estimation/episode.h"
#include "models/machine.h"

namespace hydroscope {

constexpr double kLagPeriod = 0.05, kLagRate = 4;  // s, 1/s
constexpr int kLagSubsteps = 50;                   // from a row to the next

/// Of an input at a time, s.
using LagInput = double (*)(double time);
/// Beside the lag's own rate, 1/s.
using LagLaw = double (*)(double x);

inline double Filtered(double time) {
  double u = 0;
  for (const double hertz : {0.9, 2.3, 3.9}) u += std::sin(2 * std::numbers::pi * hertz * time + hertz);
  return u;
}
inline double Stepped(double time) { return Filtered(kLagPeriod * std::floor(time / kLagPeriod + 1e-6)); }
inline double OnLines(double time) {
  const double row = std::floor(time / kLagPeriod + 1e-6), share = time / kLagPeriod - row;
  return (1 - share) * Filtered(kLagPeriod * row) + share * Filtered(kLagPeriod * (row + 1));
}
inline double Proportional(double) { return 0; }
inline double Hardening(double x) { return -400 * x * x * x; }

/// A lag, x' = -k x + u, in a log.
struct LagLog {
  LagInput input = Filtered;
  LagLaw law = Proportional;
  double late = 0;       ///< s by which its output is older than the input of its row
  double sensor = 1e-3;  ///< noise of the output
  unsigned seed = 5;
};

inline Episode LagEpisode(const LagLog& lag) {
  constexpr int kRows = 600;
  std::mt19937 random(lag.seed);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(kRows, 2);
  double x = 0;
  for (int row = 0; row < kRows; ++row) {
    const double t = kLagPeriod * row, step = kLagPeriod / kLagSubsteps;
    episode.time.push_back(t);
    episode.signal(row, 0) = lag.input(t);
    episode.signal(row, 1) = x + lag.sensor * normal(random);
    for (int k = 0; k < kLagSubsteps; ++k)
      x += step * (lag.input(t - lag.late + (k + 0.5) * step) - kLagRate * x + lag.law(x)) /
           (1 + step * kLagRate / 2);
  }
  return episode;
}

/// Its machine; `log`: what the file says of how the log was measured, `effects`: further sections.
inline Machine LagMachine(const std::string& log, const std::string& effects = "") {
  auto machine = ParseMachine("[log]\n" + log + R"toml(
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
x = { ddt = "-k*x + u", initial = "estimate" }
[outputs]
y = "x"
[parameters]
k = { start = 3, min = 0.1, max = 30, unit = "1/s" }
)toml" + effects,
                              "lag");
  EXPECT_TRUE(machine) << machine.error().text;
  return std::move(*machine);
}

}  // namespace hydroscope
