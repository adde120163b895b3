#include "estimation/signal_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "simulator/random.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

constexpr double kNoStated = std::numeric_limits<double>::quiet_NaN();
constexpr double kRowPeriod = 0.002;

/// Twelve strokes of 1.6 s: a slow swing of the signal, with corners, and noise of variance 1 (AR(1), phi).
std::vector<SignalRuns> Strokes(std::uint64_t seed, double phi, double swing = 300, int rows = 800) {
  RandomStream random(seed);
  std::vector<SignalRuns> strokes;
  for (int s = 0; s < 12; ++s) {
    std::vector<double> run;
    double e = random.Normal(), level = 0;
    const double begin = random.Uniform(0.2, 0.8) * rows, frequency = random.Uniform(1, 3);
    for (int k = 0; k < rows; ++k) {
      if (k > begin) level += 0.001 * swing;
      run.push_back(level + swing * std::sin(frequency * k * kRowPeriod) + e);
      e = phi * e + std::sqrt(1 - phi * phi) * random.Normal();
    }
    strokes.push_back({run});
  }
  return strokes;
}

SignalNoise Judged(const std::vector<SignalRuns>& strokes, double stated = kNoStated) {
  return JudgeSignalNoise("p", "Pa", strokes, kRowPeriod, stated);
}

int Accused(double phi, int draws, double swing) {
  int accused = 0;
  for (int k = 0; k < draws; ++k)
    accused += Judged(Strokes(static_cast<std::uint64_t>(k) + 1, phi, swing)).kind != NoiseKind::kWhite;
  return accused;
}

TEST(SignalNoise, AccusesNoneOf150WhiteSignals) {
  for (const double swing : {0.0, 300.0, 3000.0}) EXPECT_EQ(Accused(0, 50, swing), 0) << swing;
}

TEST(SignalNoise, SeesFilteredNoiseInTenThousandRowsFromPhi03On) {
  EXPECT_GE(Accused(0.3, 20, 300), 14);
  for (const double phi : {0.5, 0.8, 0.95}) EXPECT_GE(Accused(phi, 20, 300), 18) << phi;
}

/// What is there over two rows and not over one may be either: the rows do not show white noise.
TEST(SignalNoise, MotionDoesNotHideThatItMayBeFiltered) {
  for (const double swing : {5e3, 1e4, 2e4}) EXPECT_EQ(Accused(0.85, 20, swing), 20) << swing;
}

TEST(SignalNoise, GivesTheNoiseWithItsBand) {
  const SignalNoise noise = Judged(Strokes(7, 0));
  EXPECT_NEAR(noise.std, 1, 0.04);
  EXPECT_LT(noise.ratio_low, 1);
  EXPECT_GT(noise.ratio_high, 1);
  EXPECT_NEAR(noise.slope, 0, 0.2);
  const SignalNoise filtered = Judged(Strokes(7, 0.8));
  EXPECT_EQ(filtered.kind, NoiseKind::kColoured);
  EXPECT_GT(filtered.slope, 1);
  EXPECT_THAT(filtered.sentence.english, HasSubstr("noise of p is not white"));
}

TEST(SignalNoise, SeesReadingsThatRepeat) {
  auto strokes = Strokes(3, 0, 30);
  for (SignalRuns& stroke : strokes)
    for (double& x : stroke[0]) x = 3 * std::round(x / 3);
  const SignalNoise coarse = Judged(strokes);
  EXPECT_EQ(coarse.kind, NoiseKind::kQuantised);
  EXPECT_NEAR(coarse.quantum, 3, 1e-9);
  strokes = Strokes(3, 0, 30);
  for (SignalRuns& stroke : strokes)
    for (std::size_t k = 1; k < stroke[0].size(); k += 2) stroke[0][k] = stroke[0][k - 1];
  const SignalNoise held = Judged(strokes);
  EXPECT_EQ(held.kind, NoiseKind::kHeld);
  EXPECT_THAT(held.sentence.english, HasSubstr("updated less often than every 2 ms"));
}

TEST(SignalNoise, TellsReadingsHeldByADeadbandFromCoarseOnes) {
  auto strokes = Strokes(3, 0, 30);
  auto coarse = strokes;
  for (SignalRuns& stroke : strokes)
    for (std::size_t k = 1; k < stroke[0].size(); ++k)
      if (std::abs(stroke[0][k] - stroke[0][k - 1]) < 2) stroke[0][k] = stroke[0][k - 1];
  const SignalNoise held = Judged(strokes);
  EXPECT_EQ(held.kind, NoiseKind::kHeld);
  EXPECT_THAT(held.sentence.english, HasSubstr("only where it had moved by 2"));
  // Steps of a converter, written with few decimals.
  for (SignalRuns& stroke : coarse)
    for (double& x : stroke[0]) x = std::round(2.441 * std::round(x / 2.441));
  EXPECT_EQ(Judged(coarse).kind, NoiseKind::kQuantised);
}

/// What stands still in many rows moves by no steps of a resolution, though a log has few decimals.
TEST(SignalNoise, TakesPlayForNoSteps) {
  auto strokes = Strokes(3, 0, 30);
  for (SignalRuns& stroke : strokes) {
    double held = stroke[0].front();
    for (double& x : stroke[0]) {
      held = std::clamp(held, x - 2, x + 2);
      x = 1e-3 * std::round(1e3 * held);
    }
  }
  const SignalNoise play = Judged(strokes);
  ASSERT_GT(play.repeated, 0.4);
  EXPECT_EQ(play.kind, NoiseKind::kRepeats);
  EXPECT_THAT(play.sentence.english, testing::Not(HasSubstr("in steps of")));
  EXPECT_THAT(play.sentence.english, HasSubstr("as with play"));
}

/// What leaves the deadband is stored, to `resolution`; between stored readings the line is straight.
std::vector<SignalRuns> StoredByDeadband(std::vector<SignalRuns> strokes, double deadband,
                                         double resolution) {
  for (SignalRuns& stroke : strokes) {
    std::vector<double>& x = stroke[0];
    std::size_t stored = 0;
    for (std::size_t k = 1; k < x.size(); ++k) {
      if (std::abs(x[k] - x[stored]) <= deadband) continue;
      const double first = x[stored], slope = (x[k] - first) / static_cast<double>(k - stored);
      for (std::size_t i = stored + 1; i < k; ++i) x[i] = first + slope * static_cast<double>(i - stored);
      stored = k;
    }
    x.resize(stored + 1);
    if (resolution > 0)
      for (double& value : x) value = resolution * std::round(value / resolution);
  }
  return strokes;
}

TEST(SignalNoise, SeesLinesThatAHistorianDrewBetweenReadings) {
  for (const double resolution : {0.0, 0.001, 0.02}) {
    const SignalNoise noise = Judged(StoredByDeadband(Strokes(8, 0, 100), 1.5, resolution));
    EXPECT_EQ(noise.kind, NoiseKind::kInterpolated) << resolution;
    EXPECT_GT(noise.straight, 0.3) << resolution;
    EXPECT_THAT(noise.sentence.english, HasSubstr("p was not stored at every row"));
  }
}

TEST(SignalNoise, SeesThemInASteadyMotionToo) {
  auto strokes = Strokes(8, 0, 100);
  for (SignalRuns& stroke : strokes)
    for (std::size_t k = 0; k < stroke[0].size(); ++k) stroke[0][k] += 3.0 * static_cast<double>(k);
  EXPECT_EQ(Judged(StoredByDeadband(strokes, 12, 0.001)).kind, NoiseKind::kInterpolated);
}

TEST(SignalNoise, TakesNeitherAMotionWithoutNoiseNorACoarseReadingForDrawnLines) {
  std::vector<SignalRuns> ramps;
  for (int s = 0; s < 12; ++s) {
    std::vector<double> run;
    for (int k = 0; k < 800; ++k) run.push_back(0.1 * k + 0.05 * std::max(0, k - 50 * s));
    ramps.push_back({run});
  }
  EXPECT_NE(Judged(ramps).kind, NoiseKind::kInterpolated);
  auto coarse = Strokes(8, 0, 3000);
  for (SignalRuns& stroke : coarse)
    for (double& x : stroke[0]) x = 0.7 * std::round(x / 0.7);
  EXPECT_NE(Judged(coarse).kind, NoiseKind::kInterpolated);
}

TEST(SignalNoise, TellsMotionFromNoise) {
  RandomStream random(5);
  auto strokes = Strokes(5, 0, 0);
  for (SignalRuns& stroke : strokes)
    for (std::size_t k = 0; k < stroke[0].size(); ++k)
      stroke[0][k] += 30 * std::sin(0.35 * static_cast<double>(k));
  EXPECT_EQ(Judged(strokes).kind, NoiseKind::kSignalInContrast);
}

TEST(SignalNoise, HoldsItselfAgainstWhatIsStated) {
  const auto strokes = Strokes(6, 0);
  EXPECT_EQ(Judged(strokes, 1.0).kind, NoiseKind::kWhite);
  EXPECT_EQ(Judged(strokes, 0.5).kind, NoiseKind::kSignalInContrast);
  EXPECT_EQ(Judged(strokes, 2.0).kind, NoiseKind::kDisagreesWithStated);
}

TEST(SignalNoise, OfFewRowsIsNotKnown) {
  EXPECT_EQ(Judged({}).kind, NoiseKind::kUnknown);
  EXPECT_EQ(Judged({{{1, 2, 3}}, {{}}}).kind, NoiseKind::kUnknown);
}

}  // namespace
}  // namespace hydroscope
