#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "studies/plant_logs_benchmark.h"

namespace hydroscope {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

PlantCase CaseOf(const std::string& kind, std::vector<std::string> right) {
  PlantCase c;
  for (const PlantKind& known : PlantKinds())
    if (known.name == kind) c.kind = &known;
  c.right = std::move(right);
  return c;
}
PlantAnswer Named(std::vector<std::vector<std::string>> groups, bool flagged = false, double excess = 1) {
  return {false,
          groups.size() == 1 && groups[0].size() == 1 ? Verdict::kNamed : Verdict::kAmbiguous,
          std::move(groups),
          flagged,
          {},
          excess};
}

TEST(PlantKinds, AreAtLeastTwentyFiveOfTheirOwn) {
  std::set<std::string> names;
  for (const PlantKind& kind : PlantKinds()) names.insert(kind.name);
  EXPECT_EQ(names.size(), PlantKinds().size());
  EXPECT_GE(names.size(), 25u);
}

TEST(PlantKinds, DrawValidOptionsWithAndWithoutAnEffect) {
  std::vector<const PlantKind*> kinds;
  for (const PlantKind& kind : PlantKinds()) kinds.push_back(&kind);
  const int count = static_cast<int>(kinds.size());
  for (int k = 0; k < 4 * count; ++k) {
    const PlantCase c = DrawPlantCase(k, 3, kinds);
    const Status valid = Validate(c.options);
    ASSERT_TRUE(valid) << c.kind->name << ": " << valid.error().text;
    EXPECT_EQ(c.has_effect, c.kind->needs_effect || k / count % 2 == 1) << c.kind->name;
    EXPECT_EQ(c.has_effect, !c.options.effects.empty()) << c.kind->name;
    EXPECT_TRUE(c.Reference().effects.empty());
  }
}

TEST(PlantKinds, FurtherImperfectionsStandBesideTheFirst) {
  std::vector<const PlantKind*> kinds;
  for (const PlantKind& kind : PlantKinds()) kinds.push_back(&kind);
  for (int k = 0; k < static_cast<int>(kinds.size()); ++k) {
    const PlantCase alone = DrawPlantCase(k, 3, kinds), c = DrawPlantCase(k, 3, kinds, 2);
    const Status valid = Validate(c.options);
    ASSERT_TRUE(valid) << c.kind->name << ": " << valid.error().text;
    ASSERT_EQ(c.options.imperfections.size(), alone.options.imperfections.size() + 2);
    EXPECT_EQ(c.imperfections.size(), c.options.imperfections.size());
    if (!alone.options.imperfections.empty()) {
      EXPECT_EQ(c.options.imperfections[0].size, alone.options.imperfections[0].size);
    }
    for (const PlantKind* kind : c.imperfections)
      for (const std::string& id : kind->right) EXPECT_THAT(c.right, testing::Contains(id));
  }
}

TEST(GradeAnswer, ATrueNameInTheSetIsRightAndAFalseOneIsWrongUnlessFlagged) {
  const PlantCase c = CaseOf("K_drift", {"K_drift"});
  EXPECT_EQ(GradeAnswer(c, Named({{"K_drift"}})), PlantGrade::kRight);
  EXPECT_EQ(GradeAnswer(c, Named({{"entrained_air", "K_drift"}})), PlantGrade::kRight);
  EXPECT_EQ(GradeAnswer(c, Named({{"entrained_air"}})), PlantGrade::kWrong);
  EXPECT_EQ(GradeAnswer(c, Named({{"entrained_air"}}, true)), PlantGrade::kFlagged);
  EXPECT_TRUE(ExtraName(c, Named({{"K_drift"}, {"accumulator"}})));
  EXPECT_FALSE(ExtraName(c, Named({{"K_drift", "accumulator"}})));
}

TEST(GradeAnswer, AdequateIsRightOnlyWhereNothingNoticeableIsHidden) {
  const PlantCase c = CaseOf("K_drift", {"K_drift"});
  EXPECT_EQ(GradeAnswer(c, {false, Verdict::kAdequate, {}, false, {}, 0.01}), PlantGrade::kRight);
  EXPECT_EQ(GradeAnswer(c, {false, Verdict::kAdequate, {}, false, {}, 0.5}), PlantGrade::kMissed);
  EXPECT_EQ(GradeAnswer(c, {false, Verdict::kUnknown, {}, false, {}, 0.5}), PlantGrade::kUnknown);
  EXPECT_EQ(GradeAnswer(c, {true, Verdict::kUnknown, {}, false, {}, 0.5}), PlantGrade::kUnknown);
}

TEST(GradeAnswer, WhatExplainsOddStrokesIsAName) {
  const PlantCase c = CaseOf("intermittent_leakage", {"internal_leakage"});
  const auto odd = [](std::vector<std::string> set) {
    return PlantAnswer{false, Verdict::kAdequate, {}, false, {std::move(set)}, 0.5};
  };
  EXPECT_EQ(GradeAnswer(c, odd({"internal_leakage"})), PlantGrade::kRight);
  EXPECT_EQ(GradeAnswer(c, odd({"entrained_air"})), PlantGrade::kWrong);
  EXPECT_EQ(GradeAnswer(c, odd({})), PlantGrade::kUnknown);
}

TEST(GradeAnswer, ALogInAWrongUnitIsToBeRefused) {
  const PlantCase c = CaseOf("wrong_unit", {"internal_leakage"});
  EXPECT_EQ(GradeAnswer(c, {true, Verdict::kUnknown, {}, false, {}, 0}), PlantGrade::kRight);
  EXPECT_EQ(GradeAnswer(c, {false, Verdict::kAdequate, {}, false, {}, 0}), PlantGrade::kWrong);
  EXPECT_EQ(GradeAnswer(c, Named({{"internal_leakage"}})), PlantGrade::kWrong);
}

TEST(Identifiable, AsksForALawInTheLibraryAndAnErrorThatIsNoticed) {
  EXPECT_TRUE(Identifiable(CaseOf("coloured_noise", {}), 0));
  EXPECT_TRUE(Identifiable(CaseOf("coloured_noise", {}), 0.3));
  EXPECT_FALSE(Identifiable(CaseOf("coloured_noise", {}), 0.05));
  EXPECT_FALSE(Identifiable(CaseOf("quadratic_relief", {}), 0.3));
}

TEST(ParametersOff, CountsWhatLiesOutsideEveryValueTheParameterHad) {
  PlantCase c = CaseOf("K_drift", {"K_drift"});
  c.options.machine.K = 1.2e9;
  c.options.imperfections = {{"K_drift", -0.1, {}, ""}};
  Estimate e;
  e.parameter = "K";
  e.std = 1e6;
  e.value = 1.10e9;
  EXPECT_EQ(ParametersOff(c, {e}), "");
  e.value = 1.04e9;
  EXPECT_NE(ParametersOff(c, {e}), "");
  e.std = 1e8;
  EXPECT_EQ(ParametersOff(c, {e}), "");
}

TEST(PlantGoals, SayWhichShareIsMissed) {
  PlantTally tally;
  tally.cases = tally.fits = tally.identifiable = 200;
  tally.wrong = 1;
  tally.flagged = 4;
  tally.identifiable_unknown = 30;
  tally.fit_off = 6;
  EXPECT_TRUE(PlantGoals().Missed(tally).empty());
  tally.wrong = 2;
  ASSERT_EQ(PlantGoals().Missed(tally).size(), 1u);
  EXPECT_NE(PlantGoals().Missed(tally)[0].find("wrong: 1.0 %, allowed 0.5 %"), std::string::npos);
}

// The campaign in short, over kinds that a plant has every day. With noise, filters, steps, outliers, lost
// rows and leaks that come and go nothing false may be said.
TEST(PlantLogs, TenEverydayLogsAreAnsweredWithoutAFalseWord) {
  PlantLogsOptions options;
  options.cases = 10;
  options.seed = 5;
  options.kinds = {"coloured_noise", "heavy_tails",  "plc_filter", "quantisation", "spikes",
                   "time_jitter",    "dropped_rows", "wrong_area", "stuck",        "intermittent_leakage"};
  const auto result = RunPlantLogs(options);
  ASSERT_TRUE(result) << result.error().text;
  std::string details;
  for (const std::string& line : result->details) details += line + "\n";
  const PlantTally& tally = result->all;
  EXPECT_EQ(tally.cases, 10);
  EXPECT_EQ(tally.wrong, 0) << details;
  EXPECT_EQ(tally.fit_off, 0) << details;
  EXPECT_LE(tally.flagged + tally.extra, 1) << details;
  EXPECT_LE(tally.identifiable_unknown, 2) << details;
  EXPECT_GE(tally.right, 8) << details;
}

/// Log `number` of the campaign of `seed`, as --details tells it; "wrong" if its answer is.
std::string AnswerToLog(const std::string& kind, std::uint64_t seed, int number) {
  PlantLogsOptions options;
  options.kinds = {kind};
  options.seed = seed;
  options.first = number;
  options.cases = 1;
  const auto result = RunPlantLogs(options);
  return !result ? result.error().text : result->wrong.empty() ? result->details.front() : "wrong";
}

TEST(PlantLogs, ALawOfTimeOrTemperatureHoldsInAllStrokes) {
  EXPECT_THAT(AnswerToLog("Q_vn_drift", 31337, 22),
              HasSubstr("Q_vn_drift"));  // five strokes at its beginning were odd
  EXPECT_THAT(AnswerToLog("intermittent_effects", 88431, 248),
              AllOf(HasSubstr("odd: pressure_offset"), Not(HasSubstr("pressure_offset_temperature"))));
}

/// The flow gain follows the oil in a fifth of the strokes: each of these has one of its own, which no law of the spool is.
TEST(PlantLogs, AParameterOfItsOwnInEachOddStrokeIsNoLawOfThem) {
  EXPECT_THAT(AnswerToLog("intermittent_effects", 64207, 45), HasSubstr("adequate odd:"));
}

TEST(PlantLogs, AStretchToTheEndOfALogIsNamedThoughInDoubt) {
  EXPECT_THAT(AnswerToLog("leaky_stretch", 880011, 46), HasSubstr("odd: internal_leakage"));
}

/// An internal leak that does not grow, and a spool reading whose scale follows the oil.
TEST(PlantLogs, ALeakBesideALawOfTheOilNeedNotGrowWithIt) {
  EXPECT_THAT(AnswerToLog("displacement_gain_temperature", 880011, 93),
              HasSubstr("leakage_temperature|internal_leakage"));
}

TEST(PlantLogs, AnUnknownKindNamesTheNearest) {
  PlantLogsOptions options;
  options.kinds = {"coloured_nois"};
  const auto result = RunPlantLogs(options);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().text.find("'coloured_noise'"), std::string::npos);
}

}  // namespace
}  // namespace hydroscope
