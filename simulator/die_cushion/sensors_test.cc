#include "simulator/die_cushion/sensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace hydroscope {
namespace {

PressRow RowAt(double t) { return {t, 100e5 + t, 60e5, 210e5, 0.1, 0.2, 2, 313.15}; }

TEST(ReadSensors, RoundsToTheStepsOfTheConverter) {
  SensorQuantum quantum;
  quantum.z = 1e-3;
  PressRow row = RowAt(0);
  row.z = 0.10049;
  ReadSensors({}, quantum, {}, row);
  EXPECT_DOUBLE_EQ(row.z, 0.100);
  EXPECT_EQ(row.y_v, 0.2);
}

TEST(ReadSensors, HumHasMainsFrequencyAndTheAskedAmplitude) {
  SensorNoise noise;
  noise.hum_amplitude = 3e5;
  double in_phase = 0;
  constexpr int kRows = 5000;
  for (int k = 0; k < kRows; ++k) {
    PressRow row = RowAt(k * 0.002);
    const double before = row.p_A;
    ReadSensors(noise, {}, {}, row);
    in_phase += 2.0 / kRows * (row.p_A - before) * std::sin(2 * 3.14159265358979 * 50 * k * 0.002);
  }
  EXPECT_NEAR(in_phase, 3e5, 1e3);
}

struct Outcome {
  std::vector<PressRow> rows;
};
Outcome RunFault(const SensorFault& fault) {
  FaultInjector injector({fault});
  Outcome outcome;
  for (int k = 0; k < 2000; ++k) {
    PressRow row = RowAt(k * 0.002);
    if (injector.Apply(row)) outcome.rows.push_back(row);
  }
  return outcome;
}

TEST(FaultInjector, NanCoversExactlyTheAskedTime) {
  const auto rows = RunFault({FaultKind::kNan, "z", 1.0, 0.5, 0}).rows;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(std::isnan(rows[k].z), k >= 500 && k < 750) << k;
    EXPECT_FALSE(std::isnan(rows[k].p_A));
  }
}

TEST(FaultInjector, StuckHoldsTheReadingAtItsStart) {
  const auto rows = RunFault({FaultKind::kStuck, "p_A", 1.0, 0.5, 0}).rows;
  EXPECT_EQ(rows[749].p_A, rows[500].p_A);
  EXPECT_NE(rows[499].p_A, rows[500].p_A);
  EXPECT_NE(rows[750].p_A, rows[500].p_A);
}

TEST(FaultInjector, SpikesAreSingleReadings) {
  const auto rows = RunFault({FaultKind::kSpike, "p_B", 1.0, 0.35, 40e5}).rows;
  std::vector<std::size_t> spikes;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k].p_B != 60e5) spikes.push_back(k);
  EXPECT_THAT(spikes, testing::ElementsAre(500, 550, 600, 650));
  EXPECT_EQ(rows[500].p_B, 100e5);
  EXPECT_EQ(RunFault({FaultKind::kSpike, "p_B", 1.0, 0, 40e5}).rows[500].p_B, 100e5);
}

TEST(FaultInjector, DropoutLosesWholeRows) {
  const auto rows = RunFault({FaultKind::kDropout, "p_A", 1.0, 0.5, 0}).rows;
  ASSERT_EQ(rows.size(), 1750u);
  EXPECT_NEAR(rows[500].t - rows[499].t, 0.502, 1e-9);
}

TEST(FaultInjector, OffsetDriftGrowsToItsSizeAndStays) {
  const auto rows = RunFault({FaultKind::kOffsetDrift, "y_v", 1.0, 1.0, 0.05}).rows;
  EXPECT_EQ(rows[499].y_v, 0.2);
  EXPECT_NEAR(rows[750].y_v, 0.225, 1e-6);
  EXPECT_NEAR(rows[1999].y_v, 0.25, 1e-12);
}

TEST(FaultInjector, ClockJumpMovesTheTimeStamps) {
  const auto forever = RunFault({FaultKind::kClockJump, "p_A", 1.0, 0, 3600}).rows;
  EXPECT_NEAR(forever[499].t, 0.998, 1e-9);
  EXPECT_NEAR(forever[1999].t, 3603.998, 1e-9);
  const auto back = RunFault({FaultKind::kClockJump, "p_A", 1.0, 0.5, -0.7}).rows;
  EXPECT_LT(back[500].t, back[499].t);
  EXPECT_NEAR(back[1999].t, 3.998, 1e-9);
}

}  // namespace
}  // namespace hydroscope
