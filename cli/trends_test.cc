#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "cli/commands.h"
#include "cli/trend_output.h"
#include "core/shown_width.h"
#include "core/unwrapped_fixture.h"
#include "host/output.h"
#include "storage/storage_fixture.h"
#include "workbench/history/trend_summary.h"

namespace hydroscope {
namespace {

using namespace storage_test;
using testing::HasSubstr;
using testing::Not;

struct Outcome {
  int code = 0;
  std::string out, err;
};

Outcome Trends(std::vector<std::string> words) {
  std::vector<const char*> argv = {"hydroscope", "trends"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  CLI::App app;
  int code = -1;
  AddTrendsCommand(app, code);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  try {
    app.parse(static_cast<int>(argv.size()), argv.data());
  } catch (const CLI::ParseError& error) {
    code = app.exit(error) == 0 ? kDone : kWrongUse;
  }
  std::string out = testing::internal::GetCapturedStdout();
  return {code, std::move(out), testing::internal::GetCapturedStderr()};
}

std::string FileText(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::vector<std::string>> Cells(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::stringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::stringstream cells(line + ",");
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

void FillPress(const std::string& file, std::int64_t strokes = 30) {
  Press press(file);
  const auto run = press.Begin("a.csv");
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, strokes)));
  EXPECT_OK(press.database.FinishRun(run.id, "{}", {}));
}

void AddSecondMachine(const std::string& file) {
  Database database = Value(Database::Open(file));
  const auto machine = Value(database.MachineId("press, \"old\""));
  const int version = Value(database.PutModelVersion(machine, {0, "", ColumnNames(6)}));
  const auto run = Value(database.BeginRun(machine, version, "b.csv", "b"));
  EXPECT_OK(database.StoreStrokes(run.id, MakeStrokes(0, 3)));
}

TEST(Trends, TheTableShowsValuesInUnitsOfTheShopFloor) {
  const Folder folder;
  FillPress(folder.File());
  const Outcome run = Trends({"--db", folder.File()});
  EXPECT_EQ(run.code, kDone);
  EXPECT_THAT(run.out, HasSubstr("press 7: 30 strokes in 1 run, strokes 0 to 29 shown"));
  EXPECT_THAT(run.out, HasSubstr("last log a.csv"));
  EXPECT_THAT(run.out, HasSubstr(" bar "));
  EXPECT_THAT(run.out, HasSubstr("y_0: never excited"));
  EXPECT_THAT(run.out, Not(HasSubstr("0 of 30")));
  EXPECT_EQ(run.err, "");
}

TEST(Trends, NoLineIsLongerThanEightyCharacters) {
  const Folder folder;
  FillPress(folder.File());
  std::stringstream lines(Trends({"--db", folder.File()}).out);
  for (std::string line; std::getline(lines, line);) {
    const auto characters =
        std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
    EXPECT_LE(characters, 80) << line;
  }
}

TEST(Trends, NamesOfEffectsLeaveTheTableEightyWide) {
  MachineTrends trends;
  trends.machine = "press 7";
  trends.runs.emplace_back();
  TrendSummary leak;
  leak.parameter = "internal_leakage.G";
  leak.unit = "m3/(s Pa)";
  leak.latest.value = 4.0617e-12;
  leak.latest.std = 3.2e-14;
  leak.values.assign(12, 4e-12);
  leak.stds.assign(12, 1e-13);
  trends.summaries = {leak};
  const std::string text = TrendText(trends);
  EXPECT_THAT(text, HasSubstr("internal_leakage.G 0.02437 ± 0.00038 l/min"));
  std::stringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(ShownWidth(line), kLineWidth) << line;
}

TEST(Trends, WhyAParameterStoodStillIsToldAsFarAsTheDataSay) {
  MachineTrends trends;
  trends.runs.emplace_back();
  TrendSummary confounded, moved;
  confounded.parameter = "F_s";
  confounded.latest.reason = EstimateReason::kConfounded;
  moved.parameter = "T_c";
  moved.latest.reason = EstimateReason::kNotExcited;
  moved.since = 3;
  trends.summaries = {confounded, moved};
  const std::string text = TrendText(trends);
  EXPECT_THAT(text, HasSubstr("F_s: never told from other parameters"));
  EXPECT_THAT(text, HasSubstr("T_c: these data tell hardly anything about the parameter; last"));
}

TEST(Trends, CsvHasEveryPointWithEveryDigit) {
  const Folder folder;
  FillPress(folder.File());
  const Outcome run = Trends({"--db", folder.File(), "--csv", "-"});
  EXPECT_EQ(run.code, kDone);
  const auto rows = Cells(run.out);
  ASSERT_EQ(rows.size(), 1u + 4 * 30);
  EXPECT_EQ(
      run.out.substr(0, run.out.find('\n')),
      "machine,run,stroke,sequence,time_s,parameter,value,std,unit,oil_temperature_degC,reason,excitation,last_excited_s");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 13u) << i;
    const StrokeRecord stroke = MakeStroke(static_cast<std::int64_t>(i - 1) / 4);
    const Estimate& e = stroke.estimates[(i - 1) % 4];
    EXPECT_EQ(rows[i][0], "press 7");
    EXPECT_EQ(rows[i][5], e.parameter);
    EXPECT_EQ(std::stod(rows[i][4]), stroke.summary.end);
    EXPECT_EQ(std::stod(rows[i][6]), e.value);
    if (std::isnan(e.std))
      EXPECT_EQ(rows[i][7], "");
    else
      EXPECT_EQ(std::stod(rows[i][7]), e.std);
    EXPECT_EQ(rows[i][8], e.unit);
    if (std::isnan(stroke.summary.oil_temperature))
      EXPECT_EQ(rows[i][9], "");
    else
      EXPECT_NEAR(std::stod(rows[i][9]), stroke.summary.oil_temperature - 273.15, 1e-6);
    EXPECT_EQ(rows[i][10], ReasonName(e.reason));
  }
}

TEST(Trends, ANameFromOutsideCannotSteerATerminal) {
  const Folder folder;
  {
    Database database = Value(Database::Open(folder.File()));
    const auto machine = Value(database.MachineId("press\x1b[2J 7"));
    const int version = Value(database.PutModelVersion(machine, {0, "", ColumnNames(6)}));
    const auto run = Value(database.BeginRun(machine, version, "b\x1b.csv", "b"));
    EXPECT_OK(database.StoreStrokes(run.id, MakeStrokes(0, 3)));
  }
  for (const char* format : {"--csv", "--json"}) {
    const Outcome run = Trends({"--db", folder.File(), format, "-"});
    EXPECT_EQ(run.code, kDone);
    EXPECT_THAT(run.out, HasSubstr("[2J 7"));
    EXPECT_THAT(run.out, Not(HasSubstr("\x1b"))) << format;
  }
  EXPECT_THAT(Trends({"--db", folder.File()}).out, Not(HasSubstr("\x1b")));
}

TEST(Trends, JsonHasTheSamePointsAndCanBeCutToOneParameterAndTheLastStrokes) {
  const Folder folder;
  FillPress(folder.File());
  const Outcome run = Trends({"--db", folder.File(), "--json", folder.File("t.json"), "-p", "V0", "-n", "7"});
  EXPECT_EQ(run.code, kDone);
  const auto json = nlohmann::json::parse(FileText(folder.File("t.json")));
  EXPECT_EQ(json["schema"], kJsonSchema);
  EXPECT_EQ(json["machine"], "press 7");
  ASSERT_EQ(json["points"].size(), 7u);
  for (int i = 0; i < 7; ++i) {
    const auto& point = json["points"][i];
    EXPECT_EQ(point["sequence"], 23 + i);
    EXPECT_EQ(point["parameter"], "V0");
    EXPECT_EQ(point["value"].get<double>(), MakeStroke(23 + i).estimates[1].value);
    EXPECT_EQ(point["unit"], "m3");
  }
  EXPECT_TRUE(json["points"][0]["oil_temperature_degC"].is_null());
  EXPECT_EQ(json["summary"].size(), 1u);
}

TEST(Trends, SeveralMachinesHaveToBeChosenOrAllTaken) {
  const Folder folder;
  FillPress(folder.File());
  AddSecondMachine(folder.File());
  const Outcome neither = Trends({"--db", folder.File()});
  EXPECT_EQ(neither.code, kWrongUse);
  EXPECT_THAT(neither.err, HasSubstr("holds 2 machines: press 7, press, \"old\""));
  EXPECT_THAT(neither.err, HasSubstr("--all"));

  const Outcome one = Trends({"--db", folder.File(), "--machine", "press, \"old\"", "--csv", "-"});
  EXPECT_EQ(one.code, kDone);
  EXPECT_THAT(one.out, HasSubstr("\n\"press, \"\"old\"\"\",2,0,0,"));
  EXPECT_THAT(one.out, Not(HasSubstr("press 7")));

  const Outcome all = Trends({"--db", folder.File(), "--all", "--json", "-"});
  EXPECT_EQ(all.code, kDone);
  const auto json = nlohmann::json::parse(all.out);
  ASSERT_EQ(json["machines"].size(), 2u);
  EXPECT_EQ(json["machines"][0]["points"].size(), 120u);
  EXPECT_EQ(json["machines"][1]["points"].size(), 12u);
}

TEST(Trends, WrongNamesAreAnsweredWithTheKnownOnes) {
  const Folder folder;
  FillPress(folder.File());
  const Outcome machine = Trends({"--db", folder.File(), "-m", "pres 7"});
  EXPECT_EQ(machine.code, kWrongInput);
  EXPECT_THAT(Unwrapped(machine.err), HasSubstr("it holds: press 7. Did you mean press 7?"));
  const Outcome parameter = Trends({"--db", folder.File(), "-p", "Q_vm"});
  EXPECT_EQ(parameter.code, kWrongInput);
  EXPECT_THAT(Unwrapped(parameter.err), HasSubstr("it has: K, V0, Q_vn, y_0. Did you mean Q_vn?"));
}

TEST(Trends, ALongHistoryIsWholeThoughItIsReadInPieces) {
  const Folder folder;
  constexpr std::int64_t kStrokes = 2300;  // more than two pieces
  FillPress(folder.File(), kStrokes);
  const Outcome outcome =
      Trends({"--db", folder.File(), "--csv", folder.File("t.csv"), "--json", folder.File("t.json")});
  ASSERT_EQ(outcome.code, kDone) << outcome.err;
  const auto json = nlohmann::json::parse(FileText(folder.File("t.json")));
  const auto cells = Cells(FileText(folder.File("t.csv")));
  ASSERT_EQ(json.at("points").size() + 1, cells.size());
  std::map<std::string, std::int64_t> next;
  for (std::size_t i = 0; i < json.at("points").size(); ++i) {
    const auto& point = json.at("points")[i];
    EXPECT_EQ(point.at("sequence"), next[point.at("parameter")]++);
    EXPECT_EQ(cells[i + 1][3], std::to_string(point.at("sequence").get<std::int64_t>()));
  }
  for (const auto& [parameter, strokes] : next) EXPECT_EQ(strokes, kStrokes) << parameter;
  EXPECT_EQ(json.at("summary")[0].at("strokes"), kStrokes);
}

TEST(Trends, AMissingOrEmptyDatabaseSaysWhatToDo) {
  const Folder folder;
  const Outcome missing = Trends({"--db", folder.File("no.db")});
  EXPECT_EQ(missing.code, kWrongInput);
  EXPECT_THAT(missing.err, HasSubstr("hydroscope replay LOG --machine M.toml --db"));
  EXPECT_FALSE(std::filesystem::exists(folder.File("no.db")));

  EXPECT_OK(Database::Open(folder.File("new.db")));
  EXPECT_THAT(Trends({"--db", folder.File("new.db")}).err, HasSubstr("holds no machine yet"));

  FillPress(folder.File("idle.db"), 0);
  const Outcome idle = Trends({"--db", folder.File("idle.db")});
  EXPECT_EQ(idle.code, kWrongInput);
  EXPECT_THAT(idle.err, HasSubstr("holds no strokes or episodes yet"));
}

TEST(Trends, TwoResultsOnStdoutAndAnUnwritableFileAreRefused) {
  const Folder folder;
  FillPress(folder.File());
  EXPECT_EQ(Trends({"--db", folder.File(), "--csv", "-", "--json", "-"}).code, kWrongUse);
  EXPECT_EQ(Trends({"--db", folder.File(), "--csv", folder.File("no/such.csv")}).code, kWrongInput);
  EXPECT_EQ(Trends({"--db", folder.File(), "--last", "0"}).code, kWrongUse);
}

TEST(TrendSummary, ADriftBeyondTheNoiseIsSignificantAndNoiseIsNot) {
  for (const double drift : {0.0, 0.1, -0.1}) {
    std::vector<TrendPoint> points;
    for (int i = 0; i < 60; ++i) {
      TrendPoint point;
      point.sequence = i;
      point.estimate = {"K",
                        1e9 * (1 + drift * i / 60 + 0.01 * (Noise(i) - 0.5)),
                        1e7,
                        "Pa",
                        1,
                        1.0 * i,
                        EstimateReason::kUpdated};
      points.push_back(point);
    }
    const auto summaries = SummariseTrends(points);
    ASSERT_EQ(summaries.size(), 1u);
    ASSERT_TRUE(summaries[0].change.has_value());
    EXPECT_EQ(summaries[0].change->significant, drift != 0) << drift;
    // Centres of the outer thirds lie 2/3 of the drift apart.
    EXPECT_NEAR(*summaries[0].change->Percent(), 100 * drift * 2 / 3, 1.5);
    EXPECT_EQ(summaries[0].since, 0);
  }
}

TEST(TrendSummary, AChangeOfSomethingNearZeroIsNotGivenInPercent) {
  std::vector<TrendPoint> points(9);
  for (int i = 0; i < 9; ++i) {
    points[i].sequence = i;
    points[i].estimate = {"y_0", 1e-5, 1e-4, "1", 1, 0, EstimateReason::kUpdated};
  }
  EXPECT_FALSE(SummariseTrends(points)[0].change->Percent().has_value());
}

TEST(Trends, AChangeOfANullIsToldInItsUnitAsInTheReport) {
  MachineTrends trends;
  trends.runs = {RunInfo{.strokes = 30}};
  TrendSummary null{.parameter = "y_0", .unit = "1", .kind = FindKind("die_cushion")};
  null.latest = {"y_0", -0.0021, 1e-4, "1", 1, 0, EstimateReason::kUpdated};
  null.since = 0;
  null.change =
      TrendChange{.value = -0.0101, .std = 0.0016, .from = 0.008, .from_std = 1e-4, .significant = true};
  trends.summaries = {null};
  EXPECT_THAT(TrendText(trends), HasSubstr("% of stroke -1.01 ± 0.31, significant"));
}

TEST(TrendSummary, StrokesThatToldNothingAreNotCounted) {
  std::vector<TrendPoint> points(9);
  for (int i = 0; i < 9; ++i) {
    points[i].sequence = 100 + i;
    points[i].estimate = {
        "K", 1e9, 1e7, "Pa", 1, 0, i < 5 ? EstimateReason::kUpdated : EstimateReason::kNotExcited};
  }
  const auto summary = SummariseTrends(points)[0];
  EXPECT_EQ(summary.updated, 5);
  EXPECT_EQ(summary.strokes, 9);
  EXPECT_EQ(summary.since, 4);
  EXPECT_FALSE(summary.change.has_value()) << "five strokes are too few";
}

TEST(Sparkline, RisesWithTheValuesAndLeavesGapsWhereNothingIsKnown) {
  EXPECT_EQ(Sparkline({0, 1, 2, 3, std::nan(""), 5, 6, 7}, {}, 8), "▁▂▃▄ ▆▇█");
  EXPECT_EQ(Sparkline({0, 0, 7, 7}, {}, 2), "▁█");
  EXPECT_EQ(Sparkline({}, {}, 5), "");
}

TEST(Sparkline, NoiseStaysNearTheMiddle) {
  const std::string line = Sparkline({1.0, 1.01, 0.99, 1.0}, {0.1, 0.1, 0.1, 0.1}, 4);
  EXPECT_THAT(line, Not(HasSubstr("█")));
  EXPECT_THAT(line, Not(HasSubstr("▁")));
}

TEST(TrendOutput, AValueNearZeroHasNoPercentagesInJsonEither) {
  Machine press;
  press.model = "die_cushion";
  MachineTrends trends;
  for (const auto& [name, unit, from] :
       {std::tuple{"K", "Pa", 1.2e9}, std::tuple{"y_0", "1", 0.008}, std::tuple{"V0", "m3", 2e-3}}) {
    TrendSummary summary;
    summary.parameter = name;
    summary.unit = unit;
    summary.kind = &KindOf(press);
    summary.latest = {name, from, 0.01 * from, unit, 1, 0, EstimateReason::kUpdated};
    summary.change =
        TrendChange{.value = 0.1 * from, .std = 0.01 * from, .from = from, .from_std = 0.01 * from};
    trends.summaries.push_back(summary);
  }
  trends.summaries[2].not_trusted = Told("the error that is left could be taken for it");
  const Folder folder;
  const std::string path = folder.File() + ".json";
  ASSERT_TRUE(WriteTrendJson(path, {trends}, [](const auto&, const auto&) { return Status(); }));
  const auto summary = nlohmann::json::parse(FileText(path))["summary"];
  EXPECT_NEAR(summary[0]["change"]["percent"].get<double>(), 10, 1e-9);
  EXPECT_FALSE(summary[1]["change"].contains("percent")) << summary[1].dump(1);
  EXPECT_FALSE(summary[1]["change"].contains("percent_std"));
  EXPECT_EQ(summary[0]["reason"], "updated");
  EXPECT_EQ(summary[2]["reason"], "confounded") << "as replay and the report mark it";
  EXPECT_EQ(summary[2]["why"], "the error that is left could be taken for it");
}

}  // namespace
}  // namespace hydroscope
