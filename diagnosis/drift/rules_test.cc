#include "diagnosis/drift/rules.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace hydroscope::drift {
namespace {

std::string Text(const std::string& path) {
  std::ifstream file(std::string(HYDROSCOPE_SOURCE_DIR) + "/" + path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string ErrorOf(const std::string& text) {
  const auto rules = ParseRules(text, "r.toml");
  return rules ? "" : rules.error().text;
}

TEST(Rules, TheShippedFileIsRightAndBuiltIn) {
  const auto rules = ParseRules(Text("machines/die_cushion_rules.toml"), "die_cushion_rules.toml");
  ASSERT_TRUE(rules) << rules.error().text;
  EXPECT_EQ(DefaultRules().rules.size(), rules->rules.size());
  EXPECT_EQ(DefaultRules().minimum_temperature, 295.15);
}

TEST(Rules, NameThePatternsOfTheMachine) {
  const RuleBook& book = DefaultRules();
  const auto name = [&](std::map<std::string, int> moved, int axes = 1) {
    const Rule* rule = book.Match(moved, axes);
    return rule == nullptr ? "" : rule->id;
  };
  EXPECT_EQ(name({{"K", -1}}), "entrained_air");
  EXPECT_EQ(name({{"Q_vn", 1}}), "worn_metering_edge");
  EXPECT_EQ(name({{"Q_vn", -1}}), "clogged_valve");
  EXPECT_EQ(name({{"y_0", 1}}), "null_shift");
  EXPECT_EQ(name({{"internal_leakage", 1}}), "internal_leakage");
  EXPECT_EQ(name({{"f0", -1}}), "slow_pilot_stage");
  EXPECT_EQ(name({{"K", -1}}, 4), "supply_or_oil");
  EXPECT_EQ(name({{"K", -1}, {"internal_leakage", 1}}), "") << "no rule names both";
}

TEST(Rules, SizesAreSharesOrAbsolute) {
  const RuleBook& book = DefaultRules();
  EXPECT_DOUBLE_EQ(book.Find("K")->Sizes(1.2e9).smallest, 0.06e9);
  EXPECT_NEAR(book.Find("internal_leakage")->Sizes(0).smallest, 0.4 / 6e4 / 2e7, 1e-18);
  EXPECT_TRUE(book.Find("internal_leakage")->Sizes(0).only_upwards);
}

TEST(Rules, UnknownKeyNamesTheNearest) {
  EXPECT_NE(ErrorOf("[monitor]\ncomissioning = 200\n").find("did you mean \"commissioning\"?"),
            std::string::npos);
  EXPECT_NE(ErrorOf("[watch]\nK = {}\n[[rule]]\nid=\"a\"\nname=\"a\"\nguidance=\"a\"\nwhen={ K = \"dwn\" }\n")
                .find("did you mean \"down\"?"),
            std::string::npos);
  EXPECT_NE(ErrorOf("[[rule]]\nid=\"a\"\n").find("guidance is missing"), std::string::npos);
}

TEST(Rules, WhatIsNoListOfTablesIsRefused) {
  for (const char* text : {"rule = 3\n", "[rule]\nid=\"a\"\n", "rule = [1, 2]\n"})
    EXPECT_NE(ErrorOf(text).find("[[rule]]"), std::string::npos) << text << ErrorOf(text);
}

TEST(Rules, EveryRuleOfOursIsToldInGermanToo) {
  for (const char* file : {"die_cushion", "manipulator", "pump"}) {
    const auto book = ParseRules(Text(std::string("machines/") + file + "_rules.toml"), file);
    ASSERT_TRUE(book) << book.error().text;
    EXPECT_FALSE(book->rules.empty());
    for (const Rule& rule : book->rules) {
      EXPECT_FALSE(rule.name.german.empty()) << file << ": " << rule.id;
      EXPECT_FALSE(rule.guidance.german.empty()) << file << ": " << rule.id;
    }
  }
}

TEST(Rules, EveryKeyIsDocumented) {
  const std::string docs = Text("docs/drift.md");
  for (const RuleSection& section : RuleFileSections()) {
    if (section.name.empty()) continue;
    for (const std::string& key : section.keys)
      EXPECT_NE(docs.find("`" + key + "`"), std::string::npos) << section.name << " " << key;
  }
}

}  // namespace
}  // namespace hydroscope::drift
