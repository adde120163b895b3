#include "report/report.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "report/report_fixture.h"
#include "report/xml_check_fixture.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

/// Pages are too long to print with a failure.
bool Has(const std::string& page, const std::string& part) { return page.find(part) != page.npos; }

/// The words of the verdict box without markup.
std::string VerdictText(const std::string& page) {
  const std::size_t begin = page.find("<section class=\"verdict"), end = page.find("</section>", begin);
  return std::regex_replace(page.substr(begin, end - begin), std::regex("<[^>]*>"), "");
}

/// The words of the cards of the parameters.
std::string Cards(const std::string& page) {
  const std::size_t begin = page.find("class=\"cards\""), end = page.find("class=\"tiles\"", begin);
  return std::regex_replace(page.substr(begin, end - begin), std::regex("<[^>]*>"), " ");
}

void ExpectSound(const std::string& page) {
  EXPECT_EQ(XmlFault(page), "");
  EXPECT_FALSE(std::regex_search(page, std::regex("[^a-z]-?(nan|inf)[^a-z]")));
  EXPECT_LT(page.size(), 2'000'000u);
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"")));  // loads nothing
}

TEST(FormatReport, SaysThatTheFlowFollowsTheOilAndTheOthersDoNot) {
  const std::string page = FormatReport(ReportFixture{}.Make());
  ExpectSound(page);
  EXPECT_THAT(VerdictText(page),
              HasSubstr("follows the oil temperature; K′, V0 and y0 do not, as far as can be seen"));
  EXPECT_TRUE(Has(VerdictText(page), "in step with the oil temperature"));
  EXPECT_THAT(VerdictText(page),
              HasSubstr("A slow change of the machine at the same pace would look the same"));
}

TEST(FormatReport, DropsTheCaveatWhereTheOilAlsoCooled) {
  ReportFixture fixture;
  fixture.cools_again = true;
  const std::string text = VerdictText(FormatReport(fixture.Make()));
  EXPECT_TRUE(Has(text, "No change beyond what the oil temperature accounts for"));
  EXPECT_FALSE(Has(text, "would look the same"));
}

TEST(FormatReport, DoesNotDenyAnAlarmThatTellsAYoungChange) {
  ReportFixture fixture;
  fixture.warm = 26.5;
  ReportInput input = fixture.Make();
  EXPECT_THAT(VerdictText(FormatReport(input)), HasSubstr("No change stands out in this record"));
  AlarmState alarm;
  alarm.id = "internal_leakage";
  alarm.active = true;
  alarm.first_stroke = 290;
  input.alarms = {alarm};
  const std::string text = VerdictText(FormatReport(input));
  EXPECT_THAT(text, HasSubstr("An alarm tells a change"));
  EXPECT_THAT(text, HasSubstr("internal_leakage (stroke 290 on)"));
  EXPECT_THAT(text, testing::Not(HasSubstr("No change stands out in this record")));
}

TEST(FormatReport, ShowsNoGreenCardBesideAnAlarmOfItsParameter) {
  ReportFixture fixture;
  fixture.warm = 26.5;
  ReportInput input = fixture.Make();
  EXPECT_TRUE(Has(FormatReport(input), "No change stands out in <b>K′</b>"));
  AlarmState alarm;
  alarm.id = "unnamed_change_K";
  alarm.active = true;
  alarm.first_stroke = 290;
  alarm.quantities = {"K"};
  input.alarms = {alarm};
  const std::string page = FormatReport(input);
  ExpectSound(page);
  EXPECT_FALSE(Has(page, "No change stands out in <b>K′</b>"));
  EXPECT_TRUE(Has(page,
                  "The alarm <b>unnamed_change_K</b> tells a change since stroke 290. Over the record as a "
                  "whole it does not stand out."));
  EXPECT_THAT(VerdictText(page), HasSubstr("An alarm tells a change"));
  alarm.active = false;
  input.alarms = {alarm};
  EXPECT_TRUE(Has(FormatReport(input), "No change stands out in <b>K′</b>"));
}

TEST(FormatReport, ShowsNoGreenCardOfAParameterThatMovedWithAnAlarm) {
  ReportFixture fixture;
  fixture.warm = 26.5;
  ReportInput input = fixture.Make();
  AlarmState alarm;
  alarm.id = "internal_leakage";
  alarm.active = true;
  alarm.first_stroke = 295;
  alarm.quantities = {"internal_leakage"};
  input.alarms = {alarm};
  EXPECT_FALSE(Has(FormatReport(input), "moved with the alarm"));
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "y_0" && point.sequence >= 295)
      point.estimate.value += 12 * point.estimate.std;
  const std::string page = FormatReport(input);
  ExpectSound(page);
  EXPECT_TRUE(Has(page, "moved with the alarm"));
  EXPECT_TRUE(Has(page, "Since stroke 295, when <b>internal_leakage</b> began, the estimate has moved by"));
  EXPECT_FALSE(Has(VerdictText(page), "y0."));
}

TEST(FormatReport, NamesTheChangedParameterButNoCause) {
  ReportFixture fixture;
  fixture.wear = 0.06;
  fixture.cools_again = true;
  const std::string page = FormatReport(fixture.Make());
  ExpectSound(page);
  const std::string text = VerdictText(page);
  EXPECT_TRUE(Has(text, "Qvn changed over the record by more than the oil temperature accounts for"));
  EXPECT_TRUE(Has(text, "may be the machine, the oil or a sensor"));
  EXPECT_TRUE(Has(text, "The model error grew over the record"));
  for (const char* cause : {"worn", "wear", "leak", "seal"}) EXPECT_FALSE(Has(text, cause));
}

TEST(FormatReport, SaysOfTheModelWhatTheExplanationFound) {
  ReportInput input = ReportFixture{}.Make();
  EXPECT_TRUE(Has(VerdictText(FormatReport(input)), "about down to what sensor noise leaves"));
  input.found = ErrorFinding::kMore;
  const std::string missing = VerdictText(FormatReport(input));
  EXPECT_TRUE(Has(missing, "the model misses something")) << missing;
  EXPECT_FALSE(Has(missing, "about down to what sensor noise leaves"));
  input.rms_holdout = 3 * 0.31 / 6e4;
  input.found = ErrorFinding::kNoise;
  EXPECT_TRUE(Has(VerdictText(FormatReport(input)), "the noise is not white."));
  input.found = ErrorFinding::kMayBeNoise;
  EXPECT_TRUE(Has(VerdictText(FormatReport(input)), "the noise is not white, or the model misses something"));
  input.not_judged = "the model gives 0 throughout";
  const std::string impossible = VerdictText(FormatReport(input));
  EXPECT_TRUE(Has(impossible, "cannot be judged on these strokes: the model gives 0 throughout"));
  EXPECT_FALSE(Has(impossible, "times what"));
}

TEST(FormatReport, TellsThatTheRecordMixesVersionsOfTheModel) {
  ReportInput input = ReportFixture{}.Make();
  EXPECT_FALSE(Has(FormatReport(input), "mixes versions"));
  for (std::size_t k = input.runs.size() / 2; k < input.runs.size(); ++k) ++input.runs[k].model_version;
  EXPECT_TRUE(Has(VerdictText(FormatReport(input)),
                  fmt::format("The record mixes versions {}, {} of the model",
                              input.runs.front().model_version, input.runs.back().model_version)));
}

/// The oil explains nothing over the record as a whole, and what it does not explain is larger than the parameter was at first.
TEST(FormatReport, AParameterThatBeganNearZeroIsToldInItsUnitThroughout) {
  ReportFixture fixture;
  fixture.cools_again = true;
  ReportInput input = fixture.Make();
  const auto grown = [&](std::int64_t sequence, double kelvin) {
    const double late = static_cast<double>(sequence) / static_cast<double>(input.strokes.size());
    return 2e-4 + 8e-4 * std::max(0.0, 2 * late - 1) + 3e-4 * (kelvin - 302.15);
  };
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "V0") {
      point.estimate.value = grown(point.sequence, point.oil_temperature);
      point.estimate.std = 2e-6;
    }
  for (BlockEstimates& block : input.blocks)
    for (Estimate& estimate : block.parameters)
      if (estimate.parameter == "V0") {
        const double noise = 2e-6 * static_cast<double>(block.first / 7 % 5 - 2);
        estimate.value = grown((block.first + block.last) / 2, block.oil_temperature) + noise;
        estimate.std = 2e-6;
      }
  const std::string page = FormatReport(input);
  EXPECT_THAT(Cards(page),
              testing::ContainsRegex("from −[0-9]+ to [0-9]+ cm³  Oil temperature  no dependence seen: "
                                     "[+][0-9]+ ± [0-9]+ cm³/K"));
}

TEST(FormatReport, PutsTheVerdictBeforeEverythingElse) {
  const std::string page = FormatReport(ReportFixture{}.Make());
  const std::vector<std::string> order = {
      "class=\"verdict",           "class=\"cards\"",  "class=\"tiles\"",       "Parameters over strokes",
      "Model against measurement", "What was skipped", "How this was computed", "in one sentence"};
  std::size_t last = 0;
  for (const std::string& part : order) {
    const std::size_t at = page.find(part + "", last);
    ASSERT_NE(at, page.npos) << part;
    last = at;
  }
}

TEST(FormatReport, ShowsValuesInTheUnitsPeopleRead) {
  const std::string page = FormatReport(ReportFixture{}.Make());
  EXPECT_TRUE(std::regex_search(page, std::regex("14[0-9]{3} ± [0-9]+ bar")));
  EXPECT_TRUE(std::regex_search(page, std::regex("3[89]\\.[0-9]* ± 0\\.[0-9]* l/min")));
  EXPECT_THAT(page,
              testing::ContainsRegex("1\\.[01][0-9]* ± 0\\.0[0-9]* l<|1\\.[01][0-9]* ± 0\\.0[0-9]* l "));
  EXPECT_TRUE(Has(page, "% of stroke"));
}

TEST(FormatReport, IsSoundWithoutAnyStroke) {
  ReportInput input;
  input.machine.name = "empty";
  const std::string page = FormatReport(input);
  ExpectSound(page);
  EXPECT_TRUE(Has(VerdictText(page), "No verdict"));
  EXPECT_TRUE(Has(VerdictText(page), "No stroke was found"));
}

TEST(FormatReport, IsSoundWithOneStroke) {
  ReportFixture fixture;
  fixture.runs = fixture.strokes_per_run = 1;
  const std::string page = FormatReport(fixture.Make());
  ExpectSound(page);
  EXPECT_TRUE(Has(VerdictText(page), "this record has 1 stroke."));
}

TEST(FormatReport, IsSoundWithoutOilTemperature) {
  ReportFixture fixture;
  fixture.temperature_measured = false;
  const std::string page = FormatReport(fixture.Make());
  ExpectSound(page);
  EXPECT_TRUE(Has(page, "Whether the oil temperature did it cannot be told"));
  EXPECT_FALSE(Has(page, "oil temperature (°C)"));
}

TEST(FormatReport, IsSoundWithUndefinedNumbersEverywhere) {
  ReportInput input = ReportFixture{}.Make();
  for (std::size_t i = 0; i < input.trends.size(); i += 3) input.trends[i].estimate.value = std::nan("");
  for (std::size_t i = 0; i < input.trends.size(); i += 5) input.trends[i].estimate.std = std::nan("");
  for (std::size_t i = 0; i < input.trends.size(); i += 7) input.trends[i].oil_temperature = std::nan("");
  for (std::size_t i = 0; i < input.strokes.size(); i += 2) input.strokes[i].rms_error = std::nan("");
  input.overlays.front().measured[7] = std::nan("");
  input.overlays.push_back({});
  ExpectSound(FormatReport(input));
}

TEST(FormatReport, StaysBelowTwoMegabytesWithThousandsOfStrokes) {
  ReportFixture fixture;
  fixture.runs = 20;
  fixture.strokes_per_run = 400;
  ExpectSound(FormatReport(fixture.Make()));
}

TEST(FormatReport, EscapesNamesFromOutside) {
  ReportFixture fixture;
  fixture.runs = 2;
  ReportInput input = fixture.Make();
  input.machine.name = "<script>alert(1)</script> & Süd \xFF " + std::string(300, 'W');
  input.runs[0].source = input.runs[1].source = "a<b>.csv";
  input.skipped = {{"<i>", 1, "\"&\""}};
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "y_0")
      point.estimate.parameter = "<img>", point.estimate.unit = "m3/(s Pa)";
  input.machine.added_effects = {"<x>"};
  const std::string page = FormatReport(input);
  ExpectSound(page);
  for (const char* bad : {"<script>alert", "<img>", "<i>", "a<b>", "<x>"}) EXPECT_FALSE(Has(page, bad));
  EXPECT_TRUE(Has(page, "l/min per bar"));
}

TEST(FormatReport, SaysWhyAParameterIsNotIdentifiable) {
  ReportInput input = ReportFixture{}.Make();
  for (TrendPoint& point : input.trends)
    if (point.estimate.parameter == "V0") point.estimate.reason = EstimateReason::kConfounded;
  const std::string page = FormatReport(input);
  EXPECT_TRUE(
      Has(page, std::string("Not identifiable in this record: ") + ReasonText(EstimateReason::kConfounded)));
  EXPECT_TRUE(Has(VerdictText(page), "V0 could not be identified"));
}

TEST(FormatReport, PutsACrossedAlarmLimitFirst) {
  ReportInput input = ReportFixture{}.Make();
  input.machine.monitors = {{"Q_vn", std::nullopt, std::nullopt, std::nullopt, 6.4e-4, std::nullopt}};
  const std::string text = VerdictText(FormatReport(input));
  EXPECT_TRUE(Has(text, "An alarm limit was crossed"));
  EXPECT_TRUE(Has(text, "Qvn went beyond its alarm limit"));
}

TEST(FormatReport, GivesTheSameBytesForTheSameInput) {
  EXPECT_TRUE(FormatReport(ReportFixture{}.Make()) == FormatReport(ReportFixture{}.Make()));
}

TEST(WriteReport, WritesThePageAndSaysWhereItCould) {
  const std::string path = testing::TempDir() + "hydroscope_report_test.html";
  const ReportInput input = ReportFixture{}.Make();
  ASSERT_TRUE(WriteReport(path, input));
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_TRUE(text.str() == FormatReport(input));
  std::filesystem::remove(path);
  const Status failed = WriteReport("/no/such/folder/report.html", input);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(failed.error().text, HasSubstr("/no/such/folder/report.html"));
}

}  // namespace
}  // namespace hydroscope
