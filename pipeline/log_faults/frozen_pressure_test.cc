#include "pipeline/log_faults/frozen_pressure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace hydroscope {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPressureNoise = 1e5;  // Pa
constexpr double kRowTime = 0.002;      // s

Machine MachineOfPressures() {
  Machine machine;
  machine.model = "die_cushion";
  for (const auto& [name, unit] : {std::pair("p_A", "Pa"), {"z", "m"}, {"y_v", "1"}}) {
    SignalSpec spec;
    spec.name = spec.column = name;
    spec.unit = unit;
    machine.signals.push_back(spec);
  }
  return machine;
}

/// What is found in a cushion that goes down for 2 s and up again, over and over for 20 s, in blocks of so many rows.
std::vector<FrozenStretch> FrozenIn(const std::function<double(double)>& p_A,
                                    const std::function<double(double)>& z,
                                    std::size_t rows_per_block = 1000) {
  const Machine machine = MachineOfPressures();
  FrozenPressures frozen(machine);
  std::vector<ChannelQuality> channels(3);
  channels[0].noise_std = kPressureNoise;
  channels[1].noise_std = 2e-5;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise;
  for (std::size_t first = 0; first < 10000; first += rows_per_block) {
    SampleBlock block;
    block.Resize(3, rows_per_block);
    for (std::size_t k = 0; k < rows_per_block; ++k) {
      const double t = kRowTime * static_cast<double>(first + k);
      block.time[k] = t;
      block.signal[0][k] = p_A(t) + kPressureNoise * noise(random);
      block.signal[1][k] = z(t) + 2e-5 * noise(random);
    }
    frozen.Observe(block, channels);
  }
  return frozen.Found();
}

double GoesDownAndUp(double t) {
  return std::fmod(t, 4) < 2 ? -0.05 * std::fmod(t, 4) : -0.2 + 0.05 * std::fmod(t, 4);
}
double StaysUp(double) { return 0.2; }
double Rising(double t) { return 60e5 + 40e5 * std::sin(M_PI * t / 2); }
/// Hangs from 6.5 to 7 s.
double Hangs(double t) { return Rising(t >= 6.5 && t < 7 ? 6.5 : t); }

TEST(FrozenPressure, OneThatStandsStillUnderItsNoiseAndJumpsIsFound) {
  const auto found = FrozenIn(Hangs, GoesDownAndUp);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].signal, 0u);
  EXPECT_NEAR(found[0].begin, 6.5, 0.06);
  EXPECT_NEAR(found[0].end, 7 - kRowTime, 1e-9);
  const auto in_blocks = FrozenIn(Hangs, GoesDownAndUp, 8);
  ASSERT_EQ(in_blocks.size(), 1u) << "however rows are cut into blocks";
  EXPECT_EQ(in_blocks[0].end, found[0].end);
  const std::vector<Told> texts = FrozenTexts(found, MachineOfPressures());
  ASSERT_EQ(texts.size(), 1u);
  EXPECT_THAT(texts[0].english, HasSubstr("p_A (column p_A) stands still under its noise from 6.4"));
  EXPECT_THAT(texts[0].german, HasSubstr("steht von 6,4"));
}

TEST(FrozenPressure, OneThatMovesOnOrStandsWhereTheMachineDoesIsNone) {
  EXPECT_THAT(FrozenIn(Rising, GoesDownAndUp), IsEmpty());
  EXPECT_THAT(FrozenIn(Hangs, StaysUp), IsEmpty()) << "at rest a pressure is steady until a valve opens";
  const auto opens = [](double t) { return t < 7 ? 60e5 : 60e5 + 40e5 * (1 - std::exp(-(t - 7) / 0.01)); };
  const auto of_another = [](double t) { return t < 6.5 ? Rising(t) : t < 7 ? Rising(6.5) : 2 * Rising(t); };
  const auto jumps = [](double t) { return GoesDownAndUp(t) + (t < 7 ? 0 : 0.02); };
  EXPECT_THAT(FrozenIn(of_another, jumps), IsEmpty()) << "two logs in one file";
  EXPECT_THAT(FrozenIn(opens, GoesDownAndUp), IsEmpty()) << "within 10 ms, no jump";
}

TEST(FrozenPressure, ItsReadingsAreFlagged) {
  SampleBlock block;
  block.Resize(3, 10);
  for (std::size_t k = 0; k < 10; ++k) block.time[k] = static_cast<double>(k);
  FlagFrozen(std::vector<FrozenStretch>{{0, 2, 4}}, block);
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_EQ((block.quality[0][k] & quality::kStuck) != 0, k >= 2 && k <= 4) << k;
    EXPECT_EQ(block.quality[1][k], 0);
  }
}

}  // namespace
}  // namespace hydroscope
