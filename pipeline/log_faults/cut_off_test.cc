#include "pipeline/log_faults/cut_off.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/constants.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

Machine Cushion() {
  Machine machine;
  machine.model = "die_cushion";
  for (const auto& [name, unit] : {std::pair("p_A", "Pa"), {"z", "m"}, {"y_v", "1"}, {"p_0", "Pa"}}) {
    SignalSpec spec;
    spec.name = name;
    spec.unit = unit;
    machine.signals.push_back(spec);
  }
  return machine;
}

constexpr double kNoise = 1e5;  // Pa
constexpr std::size_t kRows = 30000;

/// A cushion that goes down 2 s and up 1 s in turn, with rests of 0.5 s, 2 ms rows; pressures and their noise as they are asked for
/// the time within the 3.5 s of a cycle.
std::vector<CutOff> Found(const std::function<double(double)>& p_A, const std::function<double(double)>& p_0,
                          const std::function<double(double)>& noise_of_p_0,
                          const std::function<double(double)>& sensor) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise;
  SampleBlock rows;
  rows.Resize(4, kRows);
  for (std::size_t k = 0; k < kRows; ++k) {
    const double t = std::fmod(static_cast<double>(k) * 0.002, 3.5);
    const double z = t < 2 ? -0.05 * t : t < 2.5 ? -0.1 : -0.1 + 0.1 * (t - 2.5);
    rows.time[k] = static_cast<double>(k) * 0.002;
    rows.signal[0][k] = sensor(p_A(t) + kNoise * noise(random)) + 0.03 * kNoise * noise(random);
    rows.signal[1][k] = z + 2e-5 * noise(random);
    rows.signal[2][k] = t < 2 ? 0.3 : -0.3;
    rows.signal[3][k] = p_0(t) + noise_of_p_0(t) * noise(random);
  }
  const Machine machine = Cushion();
  SaturatedPressures saturated(machine);
  saturated.Observe(rows);
  return saturated.Found();
}

double Stroke(double t) { return t < 2 ? 60e5 + 140e5 * std::sin(M_PI * t / 2) : 40e5; }
double Steady(double) { return 210e5; }
double Noisy(double) { return kNoise; }
double Whole(double p) { return p; }

TEST(SaturatedPressures, NarrowNoiseAtTheTopOfWhatMovesIsAnEndOfTheSensor) {
  for (const double limit : {150e5, 137.3e5}) {
    const auto found = Found(Stroke, Steady, Noisy, [limit](double p) { return std::min(p, limit); });
    ASSERT_EQ(found.size(), 1u) << limit;
    EXPECT_EQ(found[0].signal, 0u);
    EXPECT_TRUE(found[0].upper && found[0].narrow);
    EXPECT_NEAR(found[0].from, limit, 0.5 * kNoise);
    EXPECT_THAT(found[0].text.english, HasSubstr("saturated"));
    EXPECT_THAT(found[0].text.german, HasSubstr("gesättigt"));
  }
}

TEST(SaturatedPressures, AReliefValveLeavesThePressureItsNoise) {
  EXPECT_TRUE(Found([](double t) { return std::min(Stroke(t), 150e5); }, Steady, Noisy, Whole).empty());
}

TEST(SaturatedPressures, ASupplyThatIsQuietAtRestIsNone) {
  const auto sags = [](double t) { return t < 2 ? 200e5 : 210e5; };
  const auto rests = [](double t) { return t >= 2 && t < 2.5 ? 0.03 * kNoise : kNoise; };
  EXPECT_TRUE(Found(Stroke, sags, rests, Whole).empty());
}

TEST(CutOff, WhereTheNoiseIsCutOffIsSaid) {
  const Machine machine = Cushion();
  std::vector<ChannelQuality> channels(4);
  for (std::size_t s = 0; s < 4; ++s) channels[s].name = machine.signals[s].name;
  EXPECT_TRUE(CutOffsOf(channels, machine).empty());
  channels[0].cut_off[0] = 150e5;
  const auto found = CutOffsOf(channels, machine);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].text.english, HasSubstr("p_A never reads above 150 bar"));
  EXPECT_THAT(found[0].text.english, HasSubstr("saturation"));
  EXPECT_THAT(found[0].text.german, HasSubstr("p_A zeigt nie mehr als 150 bar"));
  const Machine within = Within(machine, found);
  EXPECT_LT(*within.signals[0].max, 150e5);
  EXPECT_FALSE(within.signals[3].max.has_value());
}

}  // namespace
}  // namespace hydroscope
