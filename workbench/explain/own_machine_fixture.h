#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "models/machine.h"

namespace hydroscope {

inline const std::string kSealMachine = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/seal_friction.toml";

/// What is true of a simulated cylinder: force = A p + c + (F_c + mu p) sign(v).
struct Seal {
  double bore = 0.0257, c = 1.0, coulomb = 0, friction = 0;
  double noise = 0.3;  ///< N
  std::uint64_t seed = 1;
  std::vector<double> pressures = {1.0, 3.5, 6.0};  ///< bar, one run each
  std::vector<double> speeds = {0.013};             ///< m/s, of the runs in turn
};

/// Runs at constant pressures on a triangle in x with short rests where it turns, 100 rows a second,
/// written as logs in the layout of machines/seal_friction.toml.
inline std::vector<std::string> Logs(const Seal& seal) {
  std::mt19937_64 random(seal.seed);
  std::normal_distribution<double> normal;
  const double area = std::numbers::pi / 4 * seal.bore * seal.bore;
  std::vector<std::string> logs;
  for (const double bar : seal.pressures) {
    logs.push_back(testing::TempDir() + "seal_" + std::to_string(getpid()) + "_" + std::to_string(seal.seed) +
                   "_" + std::to_string(logs.size()) + ".csv");
    std::ofstream out(logs.back());
    out << std::fixed;
    const double speed = seal.speeds[(logs.size() - 1) % seal.speeds.size()];
    double x = 0;  // m
    for (int row = 0; row < 3000; ++row) {
      const double phase = std::fmod(row * 0.01, 4.0);  // s: 1.6 out, 0.4 rest, 1.6 back, 0.4 rest
      const double v = phase < 1.6 ? speed : phase < 2.0 ? 0 : phase < 3.6 ? -speed : 0;
      x += 0.01 * v;
      const double sign = phase >= 1.8 && phase < 3.8 ? -1 : 1;  // the seal holds on while the piston rests
      const double p = 1e5 * (bar + 0.05 * sign) + 200 * std::sin(0.7 * row);
      const double force =
          area * p + seal.c + (seal.coulomb + seal.friction * p) * sign + seal.noise * normal(random);
      out << row * 10.0 << "\t0\t0\t0\t" << 1e3 * x + 0.004 * normal(random) << '\t'
          << p / 1e5 + 0.0005 * normal(random) << '\t' << force << '\n';
    }
  }
  return logs;
}

/// The die cushion's balance as a user would write it.
inline Machine CushionAsExpressions(const Machine& built_in) {
  Machine machine = built_in;
  machine.model = "expressions";
  machine.geometry["A_A"].unit = "m2";
  machine.balance.output = "A_A*ddt(z)";
  machine.balance.unit = "m3/s";
  machine.balance.terms = {{"q", "sqrt(max(p_A, 0))*y_v", ""},
                           {"t2", "ddt(p_A)", ""},
                           {"t3", "z*ddt(p_A)", ""},
                           {"n", "sqrt(max(p_A, 0))", ""}};
  machine.balance.derived = {{"K", "-A_A/t3", "Pa"}, {"V0", "A_A*t2/t3", "m3"}};
  return machine;
}

}  // namespace hydroscope
