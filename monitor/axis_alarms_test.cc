#include "monitor/axis_alarms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "models/machine_kind.h"
#include "monitor/alarm_json.h"
#include "monitor/finding_explanation.h"

namespace hydroscope {
namespace {

drift::DriftFinding SofterOil() {
  drift::DriftFinding finding;
  finding.rule = "entrained_air";
  finding.name = {"Oil column softer", "Ölsäule weicher"};
  finding.guidance = {"Bleed the cylinder. Look for foam in the tank.",
                      "Den Zylinder entlüften. Nach Schaum im Tank sehen."};
  finding.since = {.last_before = 480, .low = 470, .high = 490};
  finding.parts = {{.quantity = "K", .unit = "Pa", .size = -1.2e8, .std = 3e6, .reference = 1.2e9}};
  finding.compared.text = {"Strokes 5 to 9 against 1 to 4: nothing new appeared.",
                           "Hübe 5 bis 9 gegen 1 bis 4: nichts Neues ist aufgetreten."};
  finding.compared.cause = {CauseKind::kNamed, {"entrained_air"}};
  return finding;
}

TEST(AlarmWords, FindingEvidenceAndActionStandApartInBothLanguages) {
  const AlarmWords words = WordsOf(SofterOil());
  EXPECT_EQ(words.finding.english, "Oil column softer");
  EXPECT_EQ(words.finding.german, "Ölsäule weicher");
  EXPECT_EQ(words.evidence.english,
            "since stroke 481 (471 to 491): K -10.00 ± 0.49 % (12000 -> 10800 bar). Strokes 5 to 9 against 1 "
            "to 4: nothing new appeared.");
  EXPECT_EQ(words.evidence.german,
            "seit Hub 481 (471 bis 491): K -10,00 ± 0,49 % (12000 -> 10800 bar). Hübe 5 bis 9 gegen 1 bis 4: "
            "nichts Neues ist aufgetreten.");
  EXPECT_EQ(words.action.german, "Den Zylinder entlüften. Nach Schaum im Tank sehen.");
}

TEST(AlarmWords, TheTextOfTheAlarmHoldsThemAllAndTheCause) {
  EXPECT_EQ(
      AlarmTextOf(SofterOil()),
      "since stroke 481 (471 to 491): Oil column softer; K -10.00 ± 0.49 % (12000 -> 10800 bar). "
      "Strokes 5 to 9 against 1 to 4: nothing new appeared. Cause: entrained_air. Bleed the cylinder. Look "
      "for foam in the tank.");
}

TEST(AlarmWords, WhatToDoIsAboutTheCauseThatWasFound) {
  drift::DriftFinding finding = SofterOil();
  finding.compared = {.text = Told("appeared: accumulator."),
                      .cause = {CauseKind::kNamed, {"accumulator"}},
                      .cause_title = {"Gas-charged volume", "Gasvolumen"},
                      .advice = {"Check the gas charge.", "Die Gasfüllung prüfen."}};
  EXPECT_EQ(WordsOf(finding).action.german, "Die Gasfüllung prüfen.");
  EXPECT_EQ(WordsOf(finding).finding.english, "Gas-charged volume");
  EXPECT_THAT(AlarmTextOf(finding), testing::EndsWith("Cause: accumulator. Check the gas charge."));
}

TEST(AlarmWords, ACauseThatIsNotProvenIsToldAsSuchInEveryFeed) {
  drift::DriftFinding finding = SofterOil();
  finding.compared.cause = {CauseKind::kNotProven, {"pressure_offset", "tank_pressure"}};
  EXPECT_THAT(AlarmTextOf(finding),
              testing::HasSubstr("Cause: not proven; nearest: pressure_offset, tank_pressure. Bleed"));
  EXPECT_EQ(CauseTold(finding.compared.cause).german,
            "nicht bewiesen; am nächsten kommt: pressure_offset, tank_pressure");
  AlarmState alarm;
  alarm.cause = finding.compared.cause;
  const nlohmann::json json = AlarmJson("press", alarm);
  EXPECT_EQ(json.at("cause"), "not proven; nearest: pressure_offset, tank_pressure");
  EXPECT_EQ(json.at("cause_kind"), "not_proven");
  EXPECT_EQ(json.at("cause_effects").size(), 2u);
}

TEST(AlarmWords, PercentHaveAsManyDecimalsAsTheirIntervalAsksFor) {
  drift::DriftFinding finding = SofterOil();
  finding.parts[0].std = 3e5;
  EXPECT_THAT(SizesText(finding).english, testing::HasSubstr("K -10.000 ± 0.049 %"));
  finding.parts[0].size = -1.5e9;
  EXPECT_THAT(SizesText(finding).english, testing::HasSubstr("K beyond anything physical"));
}

TEST(AlarmWords, EvidenceCallsAnEffectByItsTitle) {
  drift::DriftFinding finding = SofterOil();
  finding.parts = {
      {.quantity = "internal_leakage",
       .unit = "m3/(s Pa)",
       .size = 2e-12,
       .std = 5e-14,
       .title = {"Internal leakage past the piston seal", "Innere Leckage an der Kolbendichtung"}}};
  EXPECT_THAT(WordsOf(finding).evidence.english,
              testing::HasSubstr("Internal leakage past the piston seal +0.01200 ± 0.00059 l/min per bar"));
  EXPECT_THAT(WordsOf(finding).evidence.german,
              testing::HasSubstr("Innere Leckage an der Kolbendichtung +0,01200 ± 0,00059 l/min je bar"));
}

TEST(AlarmWords, WhatIsNotToldApartNamesItsRivals) {
  drift::DriftFinding finding = SofterOil();
  finding.name = {};
  finding.rivals = {"V0", "y_0"};
  EXPECT_EQ(
      drift::FindingText(finding),
      "since stroke 481 (471 to 491): something changed; its cause is not told apart yet; K -10.00 ± 0.49 % "
      "(12000 -> 10800 bar); would explain as much: V0, y_0");
  EXPECT_EQ(NameText(finding).german, "etwas hat sich geändert; die Ursache ist noch nicht zu unterscheiden");
}

TEST(AlarmWords, ANumberWhoseIntervalHoldsZeroHeadsNoChangeThatTheModelDoesNotDescribe) {
  drift::DriftFinding finding = SofterOil();
  finding.compared = {.text = {"the model errs more than before.", ""},
                      .described = false,
                      .cause = {CauseKind::kNotKnown, {}}};
  EXPECT_THAT(AlarmTextOf(finding), testing::HasSubstr("nearest: Oil column softer; K -10.00 ± 0.49 %"));
  finding.parts[0].std = 9e7;
  EXPECT_EQ(
      AlarmTextOf(finding),
      "since stroke 481 (471 to 491): Change that the model does not describe; whether K moved cannot be told "
      "now. the model errs more than before. Cause: not known. See `hydroscope explain` of the strokes since "
      "the change.");
  EXPECT_EQ(WordsOf(finding).finding.german, "Änderung, die das Modell nicht beschreibt");
}

TEST(AlarmWords, AnAlarmThatNoFindingRaisesSaysOneSentenceInBothLanguages) {
  StrokeRecord record;
  record.summary.counters.gated = 100;
  record.summary.counters.used = 20;
  AxisContent content;
  Machine cushion;
  cushion.model = "die_cushion";
  for (int k = 0; k < 3; ++k)
    axis_alarms::JudgeSignals(cushion, {record, k, drift::JudgementReason::kUnusable}, {}, content);
  ASSERT_EQ(content.alarms.size(), 1u);
  const AlarmState& alarm = content.alarms.front();
  EXPECT_EQ(alarm.text, alarm.words.finding.english);
  EXPECT_TRUE(alarm.words.finding.german.starts_with("nur 20 % der Zeilen")) << alarm.words.finding.german;
}

TEST(AlarmWords, BeforeStrokesAreComparedTheNameIsAFirstOne) {
  drift::DriftFinding finding = SofterOil();
  finding.compared = {};
  EXPECT_THAT(AlarmTextOf(finding),
              testing::HasSubstr("Not compared with the strokes before it yet: what it is called "
                                 "may change."));
  EXPECT_THAT(WordsOf(finding).evidence.german, testing::EndsWith("wie es heißt, kann sich ändern."));
  EXPECT_THAT(AlarmTextOf(finding, drift::ValveChecksCounted()),
              testing::Not(testing::HasSubstr("compared")));
}

TEST(AlarmWords, AHeadingThatTheComparisonDoesNotCarrySaysWhatItSees) {
  const drift::DriftFinding finding = SofterOil();
  EXPECT_EQ(TitleBeside(finding, Verdict::kAdequate, {}, {"V0"}).english,
            "Change that comparing strokes finds in V0; first taken for: Oil column softer");
  EXPECT_EQ(TitleBeside(finding, Verdict::kAmbiguous, {"internal_leakage", "external_leakage"}, {}).english,
            "Change that several effects would explain; first taken for: Oil column softer");
  EXPECT_TRUE(TitleBeside(finding, Verdict::kAdequate, {}, {"V0", "K"}).empty());
  EXPECT_TRUE(TitleBeside(finding, Verdict::kAdequate, {}, {}).empty()) << "it tells of a small change alone";
  EXPECT_TRUE(TitleBeside(finding, Verdict::kAmbiguous, {"entrained_air", "accumulator"}, {}).empty());
  EXPECT_EQ(TitleBeside(finding, Verdict::kNamed, {"pressure_offset", "tank_pressure"}, {}).english,
            "Change that other effects would explain; first taken for: Oil column softer");
  EXPECT_TRUE(TitleBeside(finding, Verdict::kNamed, {"pressure_offset"}, {"K"}).empty()) << "it was measured";
}

/// The tests begin anew at stroke 490, where the first is named: what is left of the same change is dated from there.
TEST(EndOfHealthy, WhatIsFoundBesideAFindingIsComparedWithTheStrokesBeforeThat) {
  drift::DriftFinding first = SofterOil(), second = SofterOil();
  first.since = {.last_before = 480, .low = 480, .high = 480};
  first.found = 484;
  second.since = {.last_before = 490, .low = 490, .high = 490};
  EXPECT_EQ(EndOfHealthy(first, {first, second}), 481);
  EXPECT_EQ(EndOfHealthy(second, {first, second}), 481) << "not 491: strokes of the change are not healthy";
  second.since = {.last_before = 700, .low = 695, .high = 702};
  EXPECT_EQ(EndOfHealthy(second, {first, second}), 696) << "another change";
  first.state = drift::FindingState::kGone;
  second.since.low = 490;
  EXPECT_EQ(EndOfHealthy(second, {first, second}), 491);
}

TEST(AlarmWords, ChangesOfAParameterWhoseZeroIsOneOfManyAreToldInItsUnit) {
  drift::DriftFinding finding = SofterOil();
  finding.parts = {{.quantity = "T_d", .unit = "s", .size = 2e-4, .std = 1e-5, .reference = 1e-3}};
  EXPECT_THAT(SizesText(finding).english, testing::HasSubstr("%"));
  finding.parts[0].relative = false;
  EXPECT_THAT(SizesText(finding).english, testing::Not(testing::HasSubstr("%")));
}

/// Strokes of V0 = 2 l with a std of 0.1 % each; an area that may be off by 0.5 % makes them all off by as much.
TEST(JudgeLimits, ATolerancePutsTheSideOfALimitInDoubtButNeitherRaisesNorClears) {
  Machine press;
  press.model = "die_cushion";
  const std::vector<EstimateStatement> tolerances = {{.parameter = "V0", .shared = 0.005, .why = {}}};
  MonitorSpec spec;
  spec.parameter = "V0";
  spec.warn_low = 2e-3;
  drift::RuleBook rules;
  rules.warn_delay = 1, rules.clear_delay = 1, rules.deadband = 2;
  AxisContent content;
  const auto judge = [&](double value) {
    StrokeRecord record;
    record.estimates = {{"V0", value, 2e-6, "m3", 1, 0, EstimateReason::kUpdated}};
    axis_alarms::JudgeLimits(KindOf(press), {spec}, tolerances, rules,
                             {record, 7, drift::JudgementReason::kJudged}, {}, content);
    return content.alarms.front();
  };
  AlarmState alarm = judge(1.99e-3);
  EXPECT_TRUE(alarm.active);
  EXPECT_NEAR(alarm.std, std::hypot(2e-6, 0.005 * 1.99e-3), 1e-12) << "as the value is stated";
  EXPECT_THAT(alarm.text,
              testing::HasSubstr("below the limit warn_low = 2 l; its 95 % interval reaches over it"));
  EXPECT_TRUE(judge(2.003e-3).active) << "within the deadband of 2 std";
  EXPECT_FALSE(judge(2.005e-3).active) << "outside the deadband, which tolerances do not widen";
  alarm = judge(1.9e-3);
  EXPECT_THAT(alarm.text, testing::EndsWith("warn_low = 2 l")) << "on whatever side of its tolerance";
}

}  // namespace
}  // namespace hydroscope
