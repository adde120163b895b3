#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <set>

#include "cli/commands.h"
#include "cli/trend_output.h"
#include "core/units.h"
#include "host/output.h"
#include "storage/database.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostSummaries = 5000;  ///< strokes whose oil temperature is read

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
Result<std::vector<std::string>> ChosenMachines(const TrendsArguments& a, const Database& database) {
  const auto names = database.MachineNames();
  if (!names) return tl::unexpected(names.error());
  if (names->empty())
    return BadInput("{} holds no machine yet; fill it with `hydroscope replay LOG --machine M.toml --db {}`",
                    a.db, a.db);
  if (!a.machine.empty()) {
    if (std::find(names->begin(), names->end(), a.machine) == names->end())
      return BadInput("{} has no machine \"{}\"; it holds: {}{}", a.db, a.machine, Listed(*names),
                      DidYouMean(a.machine, *names));
    return std::vector<std::string>{a.machine};
  }
  if (names->size() > 1 && !a.all)
    return UsageError("{} holds {} machines: {}. Choose one with --machine NAME, or take --all", a.db,
                      names->size(), Listed(*names));
  return *names;
}

std::vector<std::string> ParameterNames(const std::vector<TrendPoint>& points) {
  std::set<std::string> names;
  for (const TrendPoint& point : points) names.insert(point.estimate.parameter);
  return {names.begin(), names.end()};
}

/// What the report judges changes by; without it (strokes of several models, say) the estimates alone are judged.
void AddBlocks(const TrendsArguments& a, Database& database, const HistoryPart& part, MachineTrends& trends) {
  if (part.strokes() <= 0) return;
  const auto machine = StoredMachine(database, a.db, part);
  auto strokes = database.SummariesOf(part.id, part.first, part.last, kMostSummaries);
  if (!machine || !strokes) return;
  if (auto blocks = EstimateBlocks(database, part.id, *machine, *strokes); blocks)
    trends.blocks = std::move(*blocks);
  trends.strokes = std::move(*strokes);
}

Result<MachineTrends> ReadTrends(const TrendsArguments& a, Database& database, const std::string& machine) {
  MachineTrends trends{machine, {}, {}, {}, {}};
  const auto id = database.MachineId(machine);
  if (!id) return tl::unexpected(id.error());
  auto runs = database.Runs(*id);
  if (!runs) return tl::unexpected(runs.error());
  trends.runs = std::move(*runs);
  const std::int64_t strokes =
      trends.runs.empty() ? 0 : trends.runs.back().first_sequence + trends.runs.back().strokes;
  const std::int64_t first = a.last > 0 ? std::max<std::int64_t>(0, strokes - a.last) : 0;
  auto points = database.Trend(*id, a.parameter, first);
  if (!points) return tl::unexpected(points.error());
  trends.points = std::move(*points);
  AddBlocks(a, database, {machine, *id, first, strokes}, trends);
  if (!trends.points.empty() || a.parameter.empty() || strokes == 0) return trends;

  const auto all = database.Trend(*id, "", first);
  if (!all) return tl::unexpected(all.error());
  const auto names = ParameterNames(*all);
  return BadInput("{}: machine \"{}\" has no parameter \"{}\" in these strokes; it has: {}{}", a.db, machine,
                  a.parameter, Listed(names), DidYouMean(a.parameter, names));
}

Status Write(const TrendsArguments& a, const std::vector<MachineTrends>& machines) {
  if (a.csv != "-" && a.json != "-")
    for (std::size_t i = 0; i < machines.size(); ++i) Say((i > 0 ? "\n" : "") + TrendText(machines[i]));
  if (!a.csv.empty())
    if (const Status written = WriteTrendCsv(a.csv, machines); !written) return written;
  if (!a.json.empty())
    if (const Status written = WriteTrendJson(a.json, machines); !written) return written;
  return {};
}

Status RunTrends(const TrendsArguments& a) {
  if (a.csv == "-" && a.json == "-")
    return UsageError("--csv - and --json - cannot both go to stdout; give one a file");
  auto database = Database::OpenReadOnly(a.db);
  if (!database) return tl::unexpected(database.error());
  const auto names = ChosenMachines(a, *database);
  if (!names) return tl::unexpected(names.error());
  std::vector<MachineTrends> machines;
  for (const std::string& name : *names) {
    auto trends = ReadTrends(a, *database, name);
    if (!trends) return tl::unexpected(trends.error());
    if (trends->points.empty())
      std::cerr << fmt::format("{}: machine \"{}\" has no strokes yet\n", a.db, name);
    else
      machines.push_back(std::move(*trends));
  }
  if (machines.empty())
    return BadInput(
        "{} holds no strokes yet: nothing in its logs was inside the gate, or their replay was stopped "
        "before the first stroke. `hydroscope check LOG --machine M.toml` tells what a log contains",
        a.db);
  return Write(a, machines);
}

}  // namespace

void AddTrendsCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<TrendsArguments>();
  CLI::App* command = app.add_subcommand(
      "trends", "What the database recorded: every identified parameter over the strokes of a machine");
  command->add_option("--db,-d", a->db, "Database that `hydroscope replay` filled")->required();
  auto* machine =
      command->add_option("--machine,-m", a->machine, "Name of the machine, if the database holds several");
  command->add_flag("--all,-a", a->all, "All machines of the database")->excludes(machine);
  command->add_option("--parameter,-p", a->parameter, "Only this parameter, for example K");
  command->add_option("--last,-n", a->last, "Only the last N strokes")->check(CLI::PositiveNumber);
  command->add_option("--csv", a->csv, "Write all points as CSV, SI units; - is stdout, .gz is compressed");
  command->add_option("--json", a->json, "Write all points as JSON, SI units; - is stdout");
  command->footer(
      "The change compares the last third of the strokes with the first third, by the judgement of the "
      "report's\n"
      "cards: on independent blocks of strokes, significant if chance alone would show as much in less than "
      "1 % of\n"
      "records; \"with the oil\": the oil temperature accounts for it.\n"
      "Examples:\n"
      "  hydroscope trends --db press.db\n"
      "  hydroscope trends --db press.db --parameter V0 --last 200\n"
      "  hydroscope trends --db press.db --csv trends.csv\n"
      "  hydroscope trends --db works.db --machine \"press 7\" --json -\n"
      "  hydroscope trends --db works.db --all --csv - | column -s, -t | less");
  command->callback([a, &exit_code] {
    const Status done = RunTrends(*a);
    exit_code = done ? kDone : ReportError(done.error());
  });
}

}  // namespace hydroscope
