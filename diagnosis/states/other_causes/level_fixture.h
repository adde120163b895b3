#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "estimation/episode.h"
#include "models/machine.h"

namespace hydroscope {

/// A level with an outlet, read with a zero of 0.2 m and noise of 5 mm.
inline Episode LevelWithZero() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(800, 2);
  double h = 1;
  for (int row = 0; row < 800; ++row) {
    const double t = 0.5 * row, u = 1 + 0.6 * std::sin(t / 7) + 0.3 * std::sin(t / 2.3);
    episode.time.push_back(t);
    episode.signal(row, 0) = u;
    episode.signal(row, 1) = h + 0.2 + 0.005 * normal(random);
    for (int step = 0; step < 10; ++step) h += 0.05 * (0.2 * u - 0.2 * std::sqrt(h));
  }
  return episode;
}

/// Its machine, with `output` for y; `parameters`: further lines of the file, parameters first.
inline Machine LevelMachine(const std::string& output, const std::string& parameters) {
  auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "1" }
y = { column = "y", unit = "m" }
[states]
h = { ddt = "q*u - k*sqrt(max(h, 0))", initial = "y", min = 0, unit = "m" }
[outputs]
y = ")toml" + output +
                                  "\"\n[parameters]\nq = { start = 0.3, min = 0.05, max = 1 }\n"
                                  "k = { start = 0.3, min = 0.05, max = 1 }\n" +
                                  parameters,
                              "level");
  EXPECT_TRUE(machine) << machine.error().text;
  return std::move(*machine);
}

}  // namespace hydroscope
