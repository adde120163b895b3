#include "estimation/sampling_rate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "estimation/noisy_log_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

SamplingRate RateOf(const JudgedLog& log, const FloorTrust& trust) {
  const auto fit = FitBaseModel(*log.model, log.grams, log.window);
  return JudgeSamplingRate(*log.model, log.strokes, log.window, fit->theta, trust, fit->noise_floor);
}
SamplingRate RateOf(const JudgedLog& log) { return RateOf(log, log.Judge()); }

TEST(SamplingRate, IsEnoughFor500And250And100HzWhateverTheNoise) {
  for (const int every : {1, 2, 5})
    for (const double scale : {0.05, 1.0, 3.0}) {
      const SamplingRate rate = RateOf(LogWith(1, WhiteNoise, scale, every));
      EXPECT_TRUE(rate.fast_enough) << every << " " << scale << ": " << rate.sentence.english;
      EXPECT_EQ(rate.sentence.english, "");
    }
}

TEST(SamplingRate, IsEnoughAt500HzUnderNoiseThatAFilterHasPassed) {
  for (const double phi : {0.5, 0.8, 0.95}) {
    const SamplingRate rate = RateOf(LogWith(2, Filtered(phi), 0.5));
    EXPECT_TRUE(rate.fast_enough) << phi << ": " << rate.sentence.english;
  }
}

TEST(SamplingRate, IsEnoughAt250HzUnderNoiseThatComesInBursts) {
  for (const std::uint64_t seed : {2, 3}) {
    const JudgedLog log = LogWith(seed, Bursts(500, 20), 1, 2);
    FloorTrust trust = log.Judge();
    const SamplingRate rate = RateOf(log, trust);
    EXPECT_TRUE(rate.fast_enough) << seed << ": " << rate.sentence.english;
    for (SignalNoise& signal : trust.signals) signal.loud_growth = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(RateOf(log, trust).fast_enough) << seed << ": nor with the noise of quiet rows alone";
  }
}

/// Few short bursts leave open what they are: the rows are not blamed alone.
TEST(SamplingRate, IsNotBlamedAloneForFewShortBursts) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const JudgedLog log = LogWith(seed, Bursts(50, 15), 1, 2);
    for (const SignalNoise& signal : log.Judge().signals)
      if (signal.name == "p_A") {
        EXPECT_GT(signal.loud_growth, 0.6) << seed;
        EXPECT_LT(signal.loud_growth, SamplingRateOptions{}.burst_growth) << seed;
      } else if (signal.name == "y_v") {  // moves within 4 ms by more than it scatters
        EXPECT_GT(signal.loud_growth, 4) << seed;
      }
    const SamplingRate rate = RateOf(log);
    EXPECT_FALSE(rate.fast_enough) << seed;
    EXPECT_THAT(rate.sentence.english, HasSubstr("in bursts, or rows every 4 ms are too slow")) << seed;
    EXPECT_THAT(rate.why.english, HasSubstr("in bursts, or sampled too slowly")) << seed;
  }
}

TEST(SamplingRate, IsTooLowAt20And10HzWhateverTheNoise) {
  for (const int every : {25, 50})
    for (const double scale : {0.1, 1.0})
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const SamplingRate rate = RateOf(LogWith(seed, WhiteNoise, scale, every));
        EXPECT_FALSE(rate.fast_enough) << every << " " << scale << " " << rate.error / rate.output;
        EXPECT_LE(rate.needed_period, 0.02);
        EXPECT_GE(rate.needed_period, 0.001);
        EXPECT_NEAR(rate.needed_rate_hz * rate.needed_period, 1, 1e-12);
      }
  for (const std::size_t rows : {50u, 1000u})
    EXPECT_FALSE(RateOf(LogWith(1, Bursts(rows, 15), 1, 50)).fast_enough) << rows;
}

TEST(SamplingRate, SaysWhatTheBalanceNeeds) {
  const SamplingRate rate = RateOf(LogWith(4, WhiteNoise, 1.0, 50));
  EXPECT_THAT(rate.sentence.english,
              HasSubstr("sampled too slowly for this: rows every 100 ms, this balance needs"));
  EXPECT_THAT(rate.sentence.english, HasSubstr("l/min"));
}

TEST(SamplingRate, OfFewRowsIsNotJudged) {
  JudgedLog log = LogWith(4, WhiteNoise, 1.0, 50);
  const auto fit = FitBaseModel(*log.model, log.grams, log.window);
  EXPECT_TRUE(JudgeSamplingRate(*log.model, {}, log.window, fit->theta, FloorTrust{}, 0).fast_enough);
}

}  // namespace
}  // namespace hydroscope
