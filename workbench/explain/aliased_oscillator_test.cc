// A motion that is sampled below twice its frequency, and an inertia below zero, are no model that describes a log.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <vector>

#include "workbench/explain/explain_log.h"
#include "workbench/fit_log.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

constexpr double kMass = 2, kDamping = 0.01;

Machine Oscillator() {
  Machine machine;
  machine.name = "oscillator";
  machine.model = "expressions";
  for (const auto& [name, unit] : {std::pair{"x", "m"}, {"v", "m/s"}, {"F", "N"}}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    signal.unit = unit;
    machine.signals.push_back(signal);
  }
  machine.log.time_column = "t";
  machine.gate.max_stroke = 10;
  machine.balance.output = "F";
  machine.balance.unit = "N";
  machine.balance.terms = {{"m", "ddt(v)", "kg"}, {"c", "v", "N s/m"}, {"k", "x", "N/m"}};
  return machine;
}

double Rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// A lightly damped mass of `frequency` Hz on a force of steps and of noise of its own bandwidth, 60 s; `turned`: of wrong sign.
ExplainResult Explained(double frequency, double rows_a_second, bool turned = false) {
  const std::string path = testing::TempDir() + "/oscillator.csv";
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const double omega = 2 * std::numbers::pi * frequency, k = kMass * omega * omega, dt = 0.002 / frequency;
  double x = 0, v = 0, f = 0, step = 0, time = 0, next = 0;
  std::vector<double> xs, vs, fs;
  for (int row = 0; row < 60 * rows_a_second; ++row) {
    for (; time < row / rows_a_second; time += dt) {
      if (time >= next) step = 30 * normal(random), next += 2;
      f += 1.5 * omega * dt * (step - f) + 60 * std::sqrt(frequency * dt) * normal(random);
      v += dt * (f - k * x - 2 * kDamping * kMass * omega * v) / kMass;
      x += dt * v;
    }
    xs.push_back(x);
    vs.push_back(v);
    fs.push_back(turned ? -f : f);
  }
  const double noise_x = 1e-3 * Rms(xs), noise_v = 1e-3 * Rms(vs), noise_f = 1e-2 * Rms(fs);
  std::ofstream file(path);
  file.precision(9);
  file << "t,x,v,F\n";
  for (std::size_t row = 0; row < xs.size(); ++row)
    file << static_cast<double>(row) / rows_a_second << ',' << xs[row] + noise_x * normal(random) << ','
         << vs[row] + noise_v * normal(random) << ',' << fs[row] + noise_f * normal(random) << '\n';
  file.close();
  auto strokes = ReadStrokes(path, Oscillator(), KeepSamples::kYes);
  EXPECT_TRUE(strokes) << (strokes ? "" : strokes.error().text);
  auto result = ExplainStrokes(std::move(*strokes));
  EXPECT_TRUE(result) << (result ? "" : result.error().text);
  return result ? std::move(*result) : ExplainResult{};
}

TEST(AliasedOscillator, IsSampledTooSlowlyAndNeverAdequate) {
  const ExplainResult aliased = Explained(45, 50);
  EXPECT_EQ(aliased.explanation.verdict, Verdict::kUnknown);
  EXPECT_THAT(aliased.explanation.no_verdict.english,
              HasSubstr("sampled too slowly for this: v and x swing at 4"));
  EXPECT_FALSE(aliased.trust.rate.fast_enough);
  EXPECT_EQ(Explained(2, 200).explanation.verdict, Verdict::kAdequate);
}

TEST(AliasedOscillator, AnInertiaBelowZeroIsNoneThatPhysicsAllows) {
  const ExplainResult turned = Explained(2, 200, true);
  EXPECT_EQ(turned.explanation.verdict, Verdict::kUnknown);
  EXPECT_THAT(turned.explanation.no_verdict.english, HasSubstr("m comes out as -2"));
  EXPECT_THAT(turned.explanation.no_verdict.english, HasSubstr("physics forbids"));
}

}  // namespace
}  // namespace hydroscope
