#include "monitor/alarm_words.h"

#include <gtest/gtest.h>

#include "monitor/axis_alarms.h"

namespace hydroscope {
namespace {

drift::RuleBook RulesWithGuidance() {
  drift::RuleBook rules;
  drift::Rule rule;
  rule.id = "entrained_air";
  rule.name = "Oil column softer";
  rule.guidance = "Bleed the cylinder. Look for foam in the tank.";
  rules.rules.push_back(rule);
  return rules;
}

drift::DriftFinding SofterOil() {
  drift::DriftFinding finding;
  finding.rule = "entrained_air";
  finding.name = "Oil column softer";
  finding.guidance = RulesWithGuidance().rules.front().guidance;
  finding.since = {.last_before = 480, .low = 470, .high = 490};
  finding.parts = {{.quantity = "K", .unit = "Pa", .size = -1.2e8, .std = 3e6, .reference = 1.2e9}};
  finding.explanation = "Comparing strokes names entrained_air.";
  finding.cause = {CauseKind::kNamed, {"entrained_air"}};
  return finding;
}

TEST(AlarmWords, FindingEvidenceAndActionStandApart) {
  AlarmState alarm;
  alarm.id = "entrained_air";
  alarm.text = FindingWords(SofterOil());
  alarm.cause = SofterOil().cause;
  const AlarmWords words = WordsOf(alarm, RulesWithGuidance());
  EXPECT_EQ(words.finding, "Oil column softer");
  EXPECT_EQ(
      words.evidence,
      "since stroke 481 (471 to 491): K -10.0 ± 0.5 % (1.2e+04 -> 1.08e+04 bar). Comparing strokes names "
      "entrained_air.");
  EXPECT_EQ(words.action, "Bleed the cylinder. Look for foam in the tank.");
}

TEST(AlarmWords, WithoutItsRuleTheGuidanceStaysInTheEvidence) {
  AlarmState alarm;
  alarm.id = "entrained_air";
  alarm.text = FindingWords(SofterOil());
  const AlarmWords words = WordsOf(alarm, {});
  EXPECT_EQ(words.finding, "Oil column softer");
  EXPECT_NE(words.evidence.find("Bleed the cylinder"), words.evidence.npos);
  EXPECT_EQ(words.action, "");
}

TEST(AlarmWords, WhatNoFindingRaisedIsToldAsItStands) {
  AlarmState alarm;
  alarm.id = "no_samples";
  alarm.text = "since 3 s: nothing comes from p_A: check the cable";
  EXPECT_EQ(WordsOf(alarm, RulesWithGuidance()).finding, alarm.text);
}

}  // namespace
}  // namespace hydroscope
