#include "simulator/die_cushion/press.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/log_format.h"

namespace hydroscope {
namespace {

PressOptions Short(double seconds = 12) {
  PressOptions options;
  options.seconds = seconds;
  return options;
}
PressOptions With(const std::string& effect, double size, double seconds = 12) {
  PressOptions options = Short(seconds);
  options.effects = {{effect, size, {}}};
  return options;
}
void ExpectSame(const SimulatedLog& a, const SimulatedLog& b, const std::string& what) {
  EXPECT_EQ(a.t, b.t) << what;
  EXPECT_EQ(a.p_A, b.p_A) << what;
  EXPECT_EQ(a.p_B, b.p_B) << what;
  EXPECT_EQ(a.p_0, b.p_0) << what;
  EXPECT_EQ(a.z, b.z) << what;
  EXPECT_EQ(a.y_v, b.y_v) << what;
  EXPECT_EQ(a.U_v, b.U_v) << what;
  EXPECT_EQ(a.T_oil, b.T_oil) << what;
}
double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}
double StdOfDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double mean = 0, square = 0;
  const auto n = static_cast<double>(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    mean += (a[k] - b[k]) / n;
    square += (a[k] - b[k]) * (a[k] - b[k]) / n;
  }
  return std::sqrt(square - mean * mean);
}

TEST(SimulatePress, IsDeterminedByItsOptions) {
  const SimulatedLog log = SimulatePress(Short());
  EXPECT_EQ(log.rows(), 6000u);
  ExpectSame(log, SimulatePress(Short()), "again");
  PressOptions other = Short();
  other.seed = 2;
  EXPECT_NE(log.z, SimulatePress(other).z);
}

TEST(SimulatePress, HalvingTheStepChangesNothingThatASensorCouldSee) {
  PressOptions options = Short(20);
  for (const EffectInfo& info : PressEffects()) options.effects.push_back({info.id, info.typical_size, {}});
  PressOptions halved = options;
  halved.max_step /= 2;
  const SimulatedLog a = SimulateClean(options), b = SimulateClean(halved);
  EXPECT_LT(LargestDifference(a.p_A, b.p_A), 2e4);  // a tenth of the noise
  EXPECT_LT(LargestDifference(a.y_v, b.y_v), 5e-4);
  halved = options = Short(20);
  halved.max_step /= 2;
  EXPECT_LT(LargestDifference(SimulateClean(options).p_A, SimulateClean(halved).p_A), 10);
}

TEST(SimulatePress, AnEffectOfSizeZeroIsNoEffect) {
  const SimulatedLog base = SimulatePress(Short(6));
  for (const EffectInfo& info : PressEffects()) ExpectSame(base, SimulatePress(With(info.id, 0, 6)), info.id);
}

TEST(SimulatePress, EveryEffectOfTypicalSizeChangesTheLog) {
  PressOptions options = Short();
  options.oil_end = options.oil_start + 20;
  const SimulatedLog base = SimulateClean(options);
  for (const EffectInfo& info : PressEffects()) {
    options.effects = {{info.id, info.typical_size, {}}};
    const SimulatedLog log = SimulateClean(options);
    const bool seen = LargestDifference(base.p_A, log.p_A) > 1e5 ||
                      LargestDifference(base.y_v, log.y_v) > 0.002 || LargestDifference(base.z, log.z) > 2e-4;
    EXPECT_TRUE(seen) << info.id;
  }
}

TEST(SimulatePress, NoiseHasTheStatedStandardDeviations) {
  PressOptions options = Short(40);
  options.noise.U_v = 0.01;
  const SimulatedLog clean = SimulateClean(options), noisy = SimulatePress(options);
  const auto expect = [](const std::vector<double>& a, const std::vector<double>& b, double std) {
    EXPECT_NEAR(StdOfDifference(a, b), std, 0.02 * std);
  };
  expect(noisy.p_A, clean.p_A, 2.2e5);
  expect(noisy.p_B, clean.p_B, 1.1e5);
  expect(noisy.p_0, clean.p_0, 1.1e5);
  expect(noisy.z, clean.z, 1.2e-4);
  expect(noisy.y_v, clean.y_v, 6.8e-5);
  expect(noisy.U_v, clean.U_v, 0.01);
  expect(noisy.T_oil, clean.T_oil, 0.05);
}

TEST(AddSensorNoise, WithTheRunsOwnSeedEqualsTheRun) {
  PressOptions options = Short();
  options.faults = {{FaultKind::kSpike, "p_A", 3, 1, 50e5}, {FaultKind::kDropout, "p_A", 5, 0.1, 0}};
  options.quantum.z = 1e-5;
  const SimulatedLog clean = SimulateClean(options);
  ExpectSame(SimulatePress(options), AddSensorNoise(clean, options, clean.truth.options.noise_seed),
             "own seed");
  const SimulatedLog other = AddSensorNoise(clean, options, 77);
  EXPECT_NEAR(StdOfDifference(other.p_B, SimulatePress(options).p_B), 1.1e5 * std::sqrt(2.0), 5e3);
}

TEST(SimulatePress, OtherNoiseLeavesTheRamAlone) {
  PressOptions options = Short();
  options.noise_seed = 99;
  EXPECT_EQ(SimulateClean(options).z, SimulateClean(Short()).z);
}

TEST(SimulatePress, TheControllerActsOnTheNoisyReading) {
  PressOptions silent = Short();
  silent.noise = {0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_GT(StdOfDifference(SimulateClean(Short()).U_v, SimulateClean(silent).U_v), 0.003);
}

TEST(SimulatePress, DelaysShiftTheLoggedChannelOnly) {
  const SimulatedLog base = SimulateClean(Short());
  const SimulatedLog late = SimulateClean(With("position_signal_delay", 0.008));
  for (std::size_t k = 4; k < base.rows(); ++k) ASSERT_NEAR(late.z[k], base.z[k - 4], 1e-12);
  EXPECT_EQ(late.p_A, base.p_A);
  const SimulatedLog spool = SimulateClean(With("spool_signal_delay", 0.008));
  for (std::size_t k = 4; k < base.rows(); ++k) ASSERT_NEAR(spool.y_v[k], base.y_v[k - 4], 1e-12);
  const SimulatedLog pressure = SimulateClean(With("pressure_signal_delay", 0.003));  // between two samples
  for (std::size_t k = 2; k < base.rows(); ++k) {
    const double low = std::min(base.p_A[k - 2], base.p_A[k - 1]),
                 high = std::max(base.p_A[k - 2], base.p_A[k - 1]);
    ASSERT_GT(pressure.p_A[k], low - 1e5) << k;
    ASSERT_LT(pressure.p_A[k], high + 1e5) << k;
  }
}

TEST(SimulatePress, StrokesGoDownAtTheirOwnSpeedWithinTheLimits) {
  PressOptions options = Short(60);
  const SimulatedLog log = SimulateClean(options);
  ASSERT_GE(log.truth.strokes.size(), 6u);
  double slowest = 1, fastest = 0;
  for (const StrokeTruth& stroke : log.truth.strokes) {
    EXPECT_GE(stroke.speed, 0.020);
    EXPECT_LE(stroke.speed, 0.120);
    slowest = std::min(slowest, stroke.speed);
    fastest = std::max(fastest, stroke.speed);
    if (stroke.end >= 60) continue;
    EXPECT_NEAR(stroke.z_begin, 0.2, 1e-3);
    EXPECT_NEAR(stroke.z_end, 0.011, 0.005);
    const auto middle = static_cast<std::size_t>((stroke.begin + stroke.end) / 2 / 0.002);
    EXPECT_NEAR((log.z[middle + 10] - log.z[middle - 10]) / 0.04, -stroke.speed, 1e-9);
    EXPECT_GT(stroke.max_pressure, stroke.mean_pressure);
  }
  EXPECT_GT(fastest, 1.5 * slowest);
  options.motion.speed_min = options.motion.speed_max = 0.05;
  for (const StrokeTruth& stroke : SimulateClean(options).truth.strokes) EXPECT_EQ(stroke.speed, 0.05);
}

TEST(SimulatePress, OilWarmsFromStartToEnd) {
  PressOptions options = Short();
  options.oil_start = 299.15;
  options.oil_end = 325.15;
  const SimulatedLog log = SimulateClean(options);
  EXPECT_DOUBLE_EQ(log.T_oil.front(), 299.15);
  EXPECT_NEAR(log.T_oil.back(), 325.15, 0.01);
}

TEST(PressGenerator, RowsDoNotDependOnTheLengthAskedFor) {
  PressGenerator generator(Short(4));
  const SimulatedLog log = SimulatePress(Short(8));
  EXPECT_EQ(generator.total_rows(), 2000);
  std::size_t k = 0;
  for (PressRow row; generator.Next(row); ++k) ASSERT_EQ(row.p_A, log.p_A[k]) << k;
  EXPECT_EQ(k, 2000u);
}

TEST(RandomMachine, IsValidVariedAndKeepsItsPressure) {
  double lowest = 1e12, highest = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    PressOptions options = RandomMachine(seed);
    options.seconds = 15;
    const Status status = Validate(options);
    ASSERT_TRUE(status) << status.error().text;
    lowest = std::min(lowest, options.machine.K);
    highest = std::max(highest, options.machine.K);
    const SimulatedLog log = SimulateClean(options);
    EXPECT_LT(*std::max_element(log.p_A.begin(), log.p_A.end()), 320e5) << seed;
    const auto low = std::count_if(log.p_A.begin(), log.p_A.end(), [](double p) { return p < 1e5; });
    EXPECT_LT(low, 100) << seed;
  }
  EXPECT_GT(highest, 1.7 * lowest);
}

TEST(FourCushions, ShareTheRamAndDifferInEverythingElse) {
  const auto cushions = FourCushions(Short());
  const SimulatedLog first = SimulateClean(cushions[0]);
  for (int k = 1; k < 4; ++k) {
    const SimulatedLog other = SimulateClean(cushions[k]);
    EXPECT_EQ(other.z, first.z);
    EXPECT_NE(other.p_A, first.p_A);
    EXPECT_NE(cushions[k].machine.K, cushions[0].machine.K);
    EXPECT_NEAR(cushions[k].machine.K, 1.21e9, 0.06e9);
    EXPECT_NE(cushions[k].noise_seed, cushions[0].noise_seed);
  }
}

TEST(Validate, NamesTheValueTheLimitAndTheNearestEffect) {
  PressOptions options = With("internal_leakge", 4e-12);
  ASSERT_FALSE(Validate(options));
  EXPECT_NE(Validate(options).error().text.find("did you mean 'internal_leakage'"), std::string::npos);
  options = With("relief_valve", 2e-11);
  options.effects[0].extra["crak"] = 170e5;
  ASSERT_FALSE(Validate(options));
  EXPECT_NE(Validate(options).error().text.find("crack"), std::string::npos);
  options = Short();
  options.motion.speed_max = 0.01;
  ASSERT_FALSE(Validate(options));
  EXPECT_NE(Validate(options).error().text.find("0.01"), std::string::npos);
  options = Short();
  options.faults = {{FaultKind::kNan, "p_C", 1, 1, 0}};
  ASSERT_FALSE(Validate(options));
  EXPECT_NE(Validate(options).error().text.find("p_C"), std::string::npos);
}

TEST(AppendPressLine, KeepsPositionsToTenNanometresAndLeavesMissingValuesEmpty) {
  std::string text;
  AppendPressLine({0.002, 1.5e7, NAN, 2.1e7, 0.12345678, 0.1, 1.25, 313.15}, text);
  EXPECT_EQ(text, "0.002000,15000000.0,,21000000.0,0.12345678,0.10000000,1.250000,40.0000\n");
}

TEST(Press, AVentedSensorReadsItsZeroErrorAlone) {
  PressOptions options;
  options.effects = {{"pressure_offset", 3e5, {}}};
  options.imperfections = {{"pressure_zero", 2e5, {}, ""}, {"tank_pressure", 4e5, {}, ""}};
  EXPECT_NEAR(VentedReading(options, 10), 5e5, 5 * options.noise.p_A / std::sqrt(5000.0));
  EXPECT_EQ(TankLinePressure(options), 4e5);
}

}  // namespace
}  // namespace hydroscope
