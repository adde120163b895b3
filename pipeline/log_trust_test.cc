#include "pipeline/log_trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_log.h"
#include "workbench/explain/explain_output.h"
#include "workbench/fit_suspicion.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Every `every`-th row of a log of a random machine.
LogStrokes Thinned(std::uint64_t seed, const std::vector<EffectSetting>& effects, std::size_t every) {
  PressOptions options = RandomMachine(seed);
  options.seconds = 90;
  options.effects = effects;
  const SimulatedLog full = SimulatePress(options);
  SimulatedLog log;
  log.truth = full.truth;
  log.truth.options.sample_period *= static_cast<double>(every);
  for (std::size_t k = 0; k < full.rows(); k += every) log.Append(full.Row(k));
  return *StrokesOf(log, MachineFor(options), KeepSamples::kYes);
}

TEST(LogTrust, GivesNoVerdictWhereRowsAreTooFarApart) {
  for (const std::uint64_t seed : {1, 2}) {
    const auto result = ExplainStrokes(Thinned(seed, {{"internal_leakage", 1e-12, {}}}, 50));
    ASSERT_TRUE(result) << result.error().text;
    const Explanation& x = result->explanation;
    EXPECT_EQ(x.verdict, Verdict::kUnknown);
    EXPECT_THAT(x.set, IsEmpty());
    EXPECT_THAT(InEnglish(x.warnings), Contains(HasSubstr("sampled too slowly for this: rows every 100 ms")));
    EXPECT_THAT(ExplainText(*result), HasSubstr("these strokes carry no verdict"));
    const FitSuspicion suspicion = SuspicionOf(*result);
    EXPECT_THAT(InEnglish(suspicion.warnings), Contains(HasSubstr("sampled too slowly")));
    EXPECT_THAT(InEnglish(suspicion.warnings), Not(Contains(HasSubstr("that no known effect explains"))));
    const nlohmann::json json = ExplainJson(*result);
    EXPECT_EQ(json.at("verdict"), "unknown");
    EXPECT_FALSE(json.at("sampling").at("fast_enough").get<bool>());
    EXPECT_NEAR(json.at("sampling").at("period_s").get<double>(), 0.1, 1e-9);
  }
}

TEST(LogTrust, LeavesVerdictsOfDenseRowsAsTheyAre) {
  for (const std::size_t every : {1, 5}) {
    const LogTrust trust = JudgeStrokes(Thinned(3, {}, every));
    EXPECT_TRUE(trust.rate.fast_enough) << every << trust.rate.sentence.english;
    EXPECT_TRUE(trust.floor.believable) << every << trust.floor.why;
    EXPECT_THAT(trust.Warnings(), IsEmpty());
  }
}

}  // namespace
}  // namespace hydroscope
