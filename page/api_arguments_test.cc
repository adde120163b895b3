#include "page/api_arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

TEST(ApiArguments, TakesWork) {
  const auto add = ParseWorkRequest(R"({"kind": "add", "effect": "some_effect"})");
  ASSERT_TRUE(add);
  EXPECT_EQ(add->kind, WorkRequest::Kind::kAdd);
  EXPECT_EQ(add->effect, "some_effect");
  const auto restore = ParseWorkRequest(R"({"kind": "restore", "version": 3})");
  ASSERT_TRUE(restore);
  EXPECT_EQ(restore->version, 3);
}

TEST(ApiArguments, NamesWhatIsWrongWithWork) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "no JSON object"},
      {"[]", "no JSON object"},
      {"{", "no JSON object"},
      {"{}", "kind: found ''"},
      {R"({"kind": 7})", "kind: found number, expected text"},
      {R"({"kind": "destroy"})", "expected one of check"},
      {R"({"kind": "add"})", "effect: expected the id"},
      {R"({"kind": "add", "effect": {}})", "effect: found object"},
      {R"({"kind": "restore"})", "version: expected a number"},
      {R"({"kind": "restore", "version": 1.5})", "version: expected a number"},
      {R"({"kind": "restore", "version": -1})", "version: expected a number"},
      {R"({"kind": "restore", "version": 1e300})", "version: expected a number"},
      {R"({"kind": "restore", "version": "1"})", "version: found string"}};
  for (const auto& [body, problem] : cases) {
    const auto parsed = ParseWorkRequest(body);
    ASSERT_FALSE(parsed) << body;
    EXPECT_THAT(parsed.error().text, HasSubstr(problem)) << body;
  }
}

TEST(ApiArguments, RefusesNamesWithoutEnd) {
  const std::string body = R"({"kind": "add", "effect": ")" + std::string(10'000, 'x') + "\"}";
  ASSERT_FALSE(ParseWorkRequest(body));
}

TEST(ApiArguments, SurvivesNestingWithoutEnd) {
  EXPECT_FALSE(ParseWorkRequest(std::string(100'000, '[')));
  EXPECT_FALSE(
      ParseColumnMapping(R"({"columns": )" + std::string(50'000, '[') + std::string(50'000, ']') + "}"));
}

TEST(ApiArguments, TakesAMapping) {
  const auto mapping = ParseColumnMapping(
      R"({"columns": [{"column": "druck", "signal": "p", "unit": "bar"}], "geometry": {"A": 0.0125},
          "gate": [{"signal": "p", "rate": true, "max": -2.5, "min": null}]})");
  ASSERT_TRUE(mapping) << mapping.error().text;
  ASSERT_EQ(mapping->columns.size(), 1u);
  EXPECT_EQ(mapping->columns[0].unit, "bar");
  EXPECT_EQ(mapping->geometry.at("A"), 0.0125);
  ASSERT_TRUE(mapping->gate);
  EXPECT_EQ(mapping->gate->at(0), (GateBound{"p", true, {}, -2.5, false}));
}

TEST(ApiArguments, LeavesTheGateAsProposedWhereNoneIsGiven) {
  const auto mapping = ParseColumnMapping("{}");
  ASSERT_TRUE(mapping);
  EXPECT_FALSE(mapping->gate);
}

TEST(ApiArguments, NamesWhatIsWrongWithAMapping) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"columns": {}})", "columns: found object, expected a list"},
      {R"({"columns": [3]})", "columns: found number, expected objects"},
      {R"({"columns": [{"column": 3}]})", "column: found number"},
      {R"({"geometry": []})", "geometry: found array"},
      {R"({"geometry": {"A": "big"}})", "geometry.A: found string"},
      {R"({"gate": [{"signal": "p", "rate": "yes"}]})", "rate: found string"},
      {R"({"gate": [{"signal": "p", "min": "low"}]})", "min: found string"}};
  for (const auto& [body, problem] : cases) {
    const auto parsed = ParseColumnMapping(body);
    ASSERT_FALSE(parsed) << body;
    EXPECT_THAT(parsed.error().text, HasSubstr(problem)) << body;
  }
}

TEST(ApiArguments, MakesFileNamesThatLeadNowhereElse) {
  EXPECT_EQ(PlainFileName("press.csv"), "press.csv");
  EXPECT_EQ(PlainFileName("../../etc/passwd"), "passwd");
  EXPECT_EQ(PlainFileName("C:\\logs\\press 1.csv"), "press_1.csv");
  EXPECT_EQ(PlainFileName(".."), "");
  EXPECT_EQ(PlainFileName(".hidden"), "hidden");
  EXPECT_EQ(PlainFileName("x." + std::string(119, 'y')), std::string(119, 'y'));
  EXPECT_EQ(PlainFileName(std::string("a\0b", 3)), "a_b");
  EXPECT_LE(PlainFileName(std::string(5000, 'x') + ".csv").size(), 120u);
  EXPECT_TRUE(PlainFileName(std::string(5000, 'x') + ".csv").ends_with(".csv"));
}

}  // namespace
}  // namespace hydroscope
