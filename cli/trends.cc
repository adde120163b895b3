#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/old_database.h"
#include "cli/trend_output.h"
#include "core/contains.h"
#include "core/shell_word.h"
#include "core/units.h"
#include "host/output.h"
#include "storage/database.h"
#include "workbench/history/stated_estimates.h"
#include "workbench/history/stored_change.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostSummaries = 5000;   ///< strokes whose oil temperature is read
constexpr std::int64_t kStrokesAtATime = 1000;  ///< whose points are in memory together

struct TrendsArguments {
  std::string db, machine, parameter, csv, json;
  bool all = false;
  std::int64_t last = 0;
};

std::string Listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string DidYouMean(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = Nearest(name, known);
  return nearest.empty() ? "" : fmt::format(". Did you mean {}?", nearest);
}

/// The machines asked for, in the order of the database.
Result<std::vector<std::string>> NamedOrAll(const TrendsArguments& a, const Database& database) {
  const auto names = TRY(database.MachineNames());
  if (names.empty())
    return BadInput("{} holds no machine yet; fill it with `hydroscope replay LOG --machine M.toml --db {}`",
                    a.db, ShellWord(a.db));
  if (!a.machine.empty()) {
    if (!Contains(names, a.machine))
      return BadInput("{} has no machine \"{}\"; it holds: {}{}", a.db, a.machine, Listed(names),
                      DidYouMean(a.machine, names));
    return std::vector<std::string>{a.machine};
  }
  if (names.size() > 1 && !a.all)
    return UsageError("{} holds {} machines: {}. Choose one with --machine NAME, or take --all", a.db,
                      names.size(), Listed(names));
  return names;
}

/// The points of a machine, read a piece at a time: a history of years is larger than memory.
TrendPoints PointsOf(const TrendsArguments& a, const Database& database) {
  return [&](const MachineTrends& trends, const std::function<bool(const TrendPoint&)>& show) -> Status {
    for (std::int64_t first = trends.begin; first < trends.end; first += kStrokesAtATime) {
      const auto points =
          TRY(database.Trend(trends.id, a.parameter, first, std::min(first + kStrokesAtATime, trends.end)));
      for (const TrendPoint& point : points)
        if (!show(point)) return {};
    }
    return {};
  };
}

/// What the report judges changes by; without blocks (strokes whose columns differ, say) the estimates alone are judged.
RecordedHistory HistoryBehind(const TrendsArguments& a, Database& database, const HistoryPart& part,
                              const std::vector<RunInfo>& runs) {
  RecordedHistory by;
  if (part.strokes() <= 0) return by;
  by.runs = runs;
  auto machine = StoredMachine(database, a.db, part);
  auto strokes = database.SummariesOf(part.id, part.first, part.last, kMostSummaries);
  if (!machine || !strokes) return by;
  if (auto blocks = EstimateBlocks(database, part.id, *machine, *strokes); blocks)
    by.blocks = std::move(*blocks);
  by.machine = std::move(*machine);
  by.strokes = std::move(*strokes);
  return by;
}

/// The newest estimates with the intervals and marks they are stated with; as they are stored where nothing tells these.
void StateSummaries(const Database& database, const Machine& machine, MachineTrends& trends) {
  const auto model = BuildModel(machine);
  if (!model) return;
  std::vector<Estimate> latest;
  for (const TrendSummary& summary : trends.summaries) latest.push_back(summary.latest);
  const auto stated = StateEstimates(database, trends.id, machine, **model, trends.runs, latest);
  if (!stated) return;
  for (std::size_t i = 0; i < latest.size(); ++i) {
    TrendSummary& summary = trends.summaries[i];
    summary.latest.std = latest[i].std;
    if (const EstimateStatement* s = FindStatement(stated->statements, summary.parameter); s != nullptr)
      summary.not_trusted = s->why;
    if (const Confounding* c = FindConfounding(stated->confounded, summary.parameter))
      summary.confounded = *c;
  }
  trends.assumed = stated->assumed;
  trends.unusual = stated->unusual;
}

Result<MachineTrends> ReadTrends(const TrendsArguments& a, Database& database, const std::string& machine) {
  MachineTrends trends;
  trends.machine = machine;
  const auto id = TRY(database.MachineId(machine));
  trends.id = id;
  trends.runs = TRY(database.Runs(id));
  trends.end = trends.runs.empty() ? 0 : trends.runs.back().first_sequence + trends.runs.back().strokes;
  trends.begin = a.last > 0 ? std::max<std::int64_t>(0, trends.end - a.last) : 0;
  TrendSummariser summariser;
  bool any = false;
  TRY(PointsOf(a, database)(trends, [&](const TrendPoint& point) {
    if (!any) trends.first = point;
    any = true;
    trends.last = point;
    summariser.Add(point);
    return true;
  }));
  const HistoryPart part{machine, id, trends.begin, trends.end};
  const MachineKind* kind = nullptr;
  const auto stored = StoredMachine(database, a.db, part);
  if (stored) {
    trends.counted = CountedWordsOf(*stored);
    kind = &KindOf(*stored);
  }
  for (AlarmState& alarm : AlarmsBeside(a.db, machine))
    if (TellsAChange(alarm)) trends.alarms.push_back(std::move(alarm));
  trends.summaries = std::move(summariser).Finish(HistoryBehind(a, database, part, trends.runs));
  for (TrendSummary& summary : trends.summaries) summary.kind = kind;
  if (stored) StateSummaries(database, *stored, trends);
  if (any || a.parameter.empty() || trends.end == 0) return trends;

  const auto names = TRY(database.ParameterNames(id));
  return BadInput("{}: machine \"{}\" has no parameter \"{}\" in these {}; it has: {}{}", a.db, machine,
                  a.parameter, trends.counted.many, Listed(names), DidYouMean(a.parameter, names));
}

Status Write(const TrendsArguments& a, const std::vector<MachineTrends>& machines,
             const TrendPoints& points) {
  if (a.csv != "-" && a.json != "-")
    for (std::size_t i = 0; i < machines.size(); ++i) Say((i > 0 ? "\n" : "") + TrendText(machines[i]));
  if (!a.csv.empty()) TRY(WriteTrendCsv(a.csv, machines, points));
  if (!a.json.empty()) TRY(WriteTrendJson(a.json, machines, points));
  return {};
}

Status RunTrends(const TrendsArguments& a) {
  if (a.csv == "-" && a.json == "-")
    return UsageError("--csv - and --json - cannot both go to stdout; give one a file");
  auto database = TRY(Database::OpenReadOnly(a.db));
  const auto names = TRY(NamedOrAll(a, database));
  SayIfOld(a.db);
  std::vector<MachineTrends> machines;
  std::int64_t silent = 0;  // strokes and episodes of machines without an estimate
  for (const std::string& name : names) {
    auto trends = TRY(ReadTrends(a, database, name));
    const std::int64_t stored = trends.end - trends.begin;
    silent += stored;
    if (trends.summaries.empty() && stored > 0)
      std::cerr << fmt::format("{}: {} of machine \"{}\" stored, none of which tells of a parameter\n", a.db,
                               trends.counted.Counted(stored), name);
    else if (trends.summaries.empty())
      std::cerr << fmt::format("{}: nothing of machine \"{}\" is stored yet\n", a.db, name);
    else
      machines.push_back(std::move(trends));
  }
  if (machines.empty() && silent > 0)
    return BadInput(
        "{} holds no estimate yet. `hydroscope fit LOG --machine M.toml` says why a log gives none", a.db);
  if (machines.empty())
    return BadInput(
        "{} holds no strokes or episodes yet: nothing in its logs was inside the gate, or their replay was stopped "
        "before the first. `hydroscope check LOG --machine M.toml` tells what a log contains",
        a.db);
  return Write(a, machines, PointsOf(a, database));
}

}  // namespace

void AddTrendsCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<TrendsArguments>();
  CLI::App* command = app.add_subcommand(
      "trends",
      "What the database recorded: every identified parameter over the strokes or episodes of a machine");
  command->add_option("--db,-d", a->db, "Database that `hydroscope replay` filled")->required();
  auto* machine = command->add_option("--machine,-m,--machine-name", a->machine,
                                      "Name of the machine, if the database holds several");
  command->add_flag("--all,-a", a->all, "All machines of the database")->excludes(machine);
  command->add_option("--parameter,-p", a->parameter, "Only this parameter, for example K");
  command->add_option("--last,-n", a->last, "Only the last N strokes or episodes")
      ->check(CLI::PositiveNumber);
  command->add_option("--csv", a->csv, "Write all points as CSV, SI units; - is stdout, .gz is compressed");
  command->add_option("--json", a->json, "Write all points as JSON, SI units; - is stdout");
  command->footer(
      "The change compares the last third of them with the first third, by the judgement of the report's\n"
      "cards: on independent blocks, significant if chance alone would show as much in less than 1 % of\n"
      "records; \"with the oil\": the oil temperature accounts for it.\n"
      "Examples:\n"
      "  hydroscope trends --db press.db\n"
      "  hydroscope trends --db press.db --parameter V0 --last 200\n"
      "  hydroscope trends --db press.db --csv trends.csv\n"
      "  hydroscope trends --db works.db --machine \"press 7\" --json -\n"
      "  hydroscope trends --db works.db --all --csv - | column -s, -t | less");
  RunsAs(*command, exit_code, [a] { return RunTrends(*a); });
}

}  // namespace hydroscope
