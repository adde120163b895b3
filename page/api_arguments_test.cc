#include "page/api_arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "page/watch/requests.h"

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
  const auto frf = ParseWorkRequest(
      R"({"kind": "frf", "method": "welch", "segment": 4096, "min_coherence": 0.9, "from": 2, "to": 80, "settle": null})");
  ASSERT_TRUE(frf);
  EXPECT_EQ(frf->response.method, FrequencyResponseMethod::kWelch);
  EXPECT_EQ(frf->response.segment_length, 4096u);
  EXPECT_EQ(frf->response.min_coherence, 0.9);
  EXPECT_EQ(frf->response.lowest, 2);
  EXPECT_EQ(frf->response.highest, 80);
  EXPECT_TRUE(std::isnan(frf->response.settle_time));
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
      {R"({"kind": "restore", "version": "1"})", "version: found string"},
      {R"({"kind": "frf", "method": "guess"})", "method: found 'guess'"},
      {R"({"kind": "frf", "segment": -2})", "segment: found -2, expected 0 to"},
      {R"({"kind": "frf", "min_coherence": 1.5})", "min_coherence: found 1.5"},
      {R"({"kind": "frf", "from": "low"})", "from: found string"}};
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

TEST(ApiArguments, TakesAKindOfMachineAndABalance) {
  const auto mapping = ParseColumnMapping(
      R"({"model": "pump", "balance": {"output": "F", "terms": [{"name": "A", "expression": "p_A"}]}})");
  ASSERT_TRUE(mapping) << mapping.error().text;
  EXPECT_EQ(mapping->model, "pump");
  ASSERT_TRUE(mapping->balance);
  EXPECT_EQ(mapping->balance->output, "F");
  EXPECT_EQ(mapping->balance->terms.at(0), (TermSpec{"A", "p_A"}));
}

TEST(ApiArguments, TakesEffectsOfAMachineOfOnesOwn) {
  const auto mapping = ParseColumnMapping(
      R"json({"effects": [{"id": "drag", "expression": "ddt(z)", "not_negative": true}, {"id": "c", "expression": ""}]})json");
  ASSERT_TRUE(mapping) << mapping.error().text;
  ASSERT_TRUE(mapping->effects);
  EXPECT_EQ(mapping->effects->at(0).terms.at(0), (TermSpec{"k", "ddt(z)"}));
  EXPECT_EQ(mapping->effects->at(0).min, 0.0);
  EXPECT_FALSE(mapping->effects->at(1).min);
  EXPECT_FALSE(ParseColumnMapping(R"json({"effects": [{"id": "Drag it", "expression": "z"}]})json"));
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
      {R"({"model": "toaster"})", "model: found 'toaster', expected one of die_cushion"},
      {R"({"balance": 3})", "balance: found number"},
      {R"({"balance": {"output": "F\n[x]"}})", "output: expected up to"},
      {R"({"balance": {"output": "F\""}})", "output: expected up to"},
      {R"({"balance": {"terms": [{"name": "A.x", "expression": "p"}]}})", "name: found 'A.x'"},
      {R"({"balance": {"terms": [{"name": "A", "expression": "p"}, {"name": "A", "expression": "x"}]}})",
       "once"},
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
  EXPECT_EQ(PlainFileName("Presse 7 – Spätschicht.csv"), "Presse_7_Spätschicht.csv");
  EXPECT_EQ(PlainFileName("\xE4\xC3.csv"), "_.csv") << "no UTF-8";
  EXPECT_EQ(PlainFileName("ä\x80.csv"), "_.csv");
  EXPECT_EQ(PlainFileName(std::string(61, 'x') + "ä" + std::string(119, 'y')), std::string(119, 'y'));
  EXPECT_EQ(PlainFileName(".."), "");
  EXPECT_EQ(PlainFileName(".hidden"), "hidden");
  EXPECT_EQ(PlainFileName("x." + std::string(119, 'y')), std::string(119, 'y'));
  EXPECT_EQ(PlainFileName(std::string("a\0b", 3)), "a_b");
  EXPECT_LE(PlainFileName(std::string(5000, 'x') + ".csv").size(), 120u);
  EXPECT_TRUE(PlainFileName(std::string(5000, 'x') + ".csv").ends_with(".csv"));
}

TEST(ApiArguments, TakesWhatIsDoneToAnAlarm) {
  const auto shelf = ParseAlarmRequest(
      R"({"action": "shelve", "machine": "press/left", "alarm": "no_samples", "user": "anna", "comment": "cable", "seconds": 3600})");
  ASSERT_TRUE(shelf) << shelf.error().text;
  EXPECT_EQ(shelf->action, AlarmRequest::Action::kShelve);
  EXPECT_EQ(shelf->alarm, "no_samples");
  EXPECT_EQ(shelf->seconds, 3600);
  EXPECT_TRUE(ParseAlarmRequest(R"({"action": "acknowledge", "alarm": "no_samples"})"));
}

TEST(ApiArguments, NamesWhatIsWrongWithAnActionOnAnAlarm) {
  const std::pair<const char*, const char*> cases[] = {
      {"7", "no JSON object"},
      {R"({"action": "delete", "alarm": "a"})", "action: found 'delete'"},
      {R"({"action": "acknowledge"})", "alarm: expected the id"},
      {R"({"action": "shelve", "alarm": "a", "comment": "why", "seconds": 0})", "seconds: expected a time"},
      {R"({"action": "shelve", "alarm": "a", "comment": "why", "seconds": 1e9})", "of at most a month"},
      {R"({"action": "shelve", "alarm": "a", "comment": "why", "seconds": "8h"})", "seconds: found string"},
      {R"({"action": "shelve", "alarm": "a", "comment": " \n", "seconds": 60})",
       "comment: expected the reason"},
      {R"({"action": "comment", "alarm": "a"})", "comment: expected a text"}};
  for (const auto& [body, problem] : cases) {
    const auto parsed = ParseAlarmRequest(body);
    ASSERT_FALSE(parsed) << body;
    EXPECT_THAT(parsed.error().text, HasSubstr(problem)) << body;
  }
  EXPECT_FALSE(ParseAlarmRequest(R"({"action": "comment", "alarm": "a", "comment": ")" +
                                 std::string(2001, 'x') + "\"}"));
}

TEST(ApiArguments, TakesQuestionsAboutTrends) {
  const auto plain = ParseTrendQuestion({{"machine", "press 7"}, {"parameter", "K"}});
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->first, 0);
  EXPECT_EQ(plain->end, -1);
  EXPECT_EQ(ParseTrendQuestion({{"parameter", "K"}, {"bins", "999999"}})->bins, TrendQuestion::kMostBins);
  EXPECT_EQ(ParseTrendQuestion({{"parameter", "K"}, {"bins", "0"}})->bins, 1);
  for (const char* wrong : {"-1", "1.5", "x", "9007199254740993", "99999999999999999999"}) {
    const auto parsed = ParseTrendQuestion({{"parameter", "K"}, {"first", wrong}});
    ASSERT_FALSE(parsed) << wrong;
    EXPECT_THAT(parsed.error().text, HasSubstr("first: expected a whole number"));
  }
  EXPECT_FALSE(ParseTrendQuestion({{"machine", "press 7"}}));
}

TEST(StrokeStretch, IsAMachineAndStrokesInOrder) {
  const auto stretch = ParseStrokeStretch(R"({"machine": "press/left", "first": 110, "last": 151})");
  ASSERT_TRUE(stretch) << stretch.error().text;
  EXPECT_EQ(stretch->machine, "press/left");
  EXPECT_EQ(stretch->first, 110);
  EXPECT_EQ(stretch->last, 151);
  for (const char* wrong :
       {"[]", R"({"machine": 3, "first": 1, "last": 2})", R"({"machine": "a", "first": 1})",
        R"({"machine": "a", "first": -1, "last": 2})", R"({"machine": "a", "first": 1.5, "last": 2})",
        R"({"machine": "a", "first": 1, "last": 1e300})", R"({"machine": "a", "first": 3, "last": 2})"})
    EXPECT_FALSE(ParseStrokeStretch(wrong)) << wrong;
}

TEST(ApiArguments, TakesStrokesToBeLearned) {
  const auto learn = ParseLearnRequest(
      R"({"machine": "m", "first": 3, "last": 9, "insist": true, "comment": "a new seal"})");
  ASSERT_TRUE(learn);
  EXPECT_EQ(learn->strokes.last, 9);
  EXPECT_TRUE(learn->insist);
  EXPECT_FALSE(learn->only_look);
  for (const char* body : {R"({"machine": "m"})", R"({"machine": "m", "first": 3, "last": 2})",
                           R"({"machine": "m", "first": 3, "last": 9, "only_look": 1})",
                           R"({"machine": "m", "first": 3, "last": 9, "insist": true, "comment": " "})"})
    EXPECT_FALSE(ParseLearnRequest(body)) << body;
}

}  // namespace
}  // namespace hydroscope
