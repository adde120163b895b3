#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/old_database.h"
#include "host/output.h"
#include "models/counted_words.h"
#include "workbench/compare_output.h"
#include "workbench/history/history_options.h"
#include "workbench/history/history_output.h"
#include "workbench/history/stored_change.h"
#include "workbench/states/states_output.h"

namespace hydroscope {
namespace {

struct CompareArguments {
  std::vector<std::string> logs;
  std::string machine, hold_out, json, csv;
  HistoryOptions history;
};

Result<std::vector<CompareResult>> CompareDatabase(const CompareArguments& a) {
  const auto chosen = TRY(OpenHistory(a.history, a.machine));
  SayIfOld(a.history.db);
  std::vector<CompareResult> results;
  for (const HistoryChoice& choice : chosen.choices) {
    const auto history = TRY(LoadHistory(chosen.database, a.history.db, choice.parts, choice.machine));
    auto result = TRY(CompareHistory(history));
    result.described = HistoryLine(history);
    if (const HistoryPart& part = choice.parts.front(); choice.parts.size() == 1)
      for (const StoredChange& change :
           FindStoredChanges(chosen.database, part, choice.machine, AlarmsBeside(a.history.db, part.machine)))
        result.warnings.push_back(WarningOfBothSides(change, CountedWordsOf(choice.machine)).english);
    results.push_back(std::move(result));
  }
  return results;
}

Result<std::vector<CompareResult>> Compare(const CompareArguments& a) {
  if (!a.history.db.empty()) return CompareDatabase(a);
  auto result = TRY(CompareLogs(a.logs, a.machine, a.hold_out));
  std::vector<CompareResult> results;
  results.push_back(std::move(result));
  return results;
}

Status CompareStates(const CompareArguments& a) {
  const auto fit = TRY(CompareStatesLogs(a.logs, a.machine, a.hold_out));
  if (a.json != "-") Say(CompareText(fit));
  if (!a.csv.empty()) TRY(WriteStatesCsv(fit, a.csv));
  if (a.json.empty()) return {};
  nlohmann::json json = CompareJson(fit);
  json["machine"] = fit.log.machine.name;
  return WriteJson(a.json, json);
}

Status RunCompare(const CompareArguments& a) {
  if (a.logs.empty() == a.history.db.empty())
    return UsageError("compare needs either a LOG with --machine, or --db DATABASE");
  if (a.history.db.empty() && a.machine.empty()) return UsageError("compare LOG needs --machine M.toml");
  if (!a.hold_out.empty() && !a.history.db.empty())
    return UsageError("--hold-out needs logs, not a database");
  if (!a.csv.empty() && !a.history.db.empty()) return UsageError("--csv needs logs, not a database");
  if (a.history.db.empty() && HasStates(a.machine)) return CompareStates(a);
  if (!a.csv.empty()) return UsageError("--csv is for machines with [states]: measured beside simulated");
  const auto results = TRY(Compare(a));
  nlohmann::json json = nlohmann::json::array();
  for (const CompareResult& result : results) {
    if (a.json != "-") Say((json.empty() ? "" : "\n") + CompareText(result));
    json.push_back(CompareJson(result));
    json.back()["machine"] = result.log.machine.name;
  }
  if (a.json.empty()) return {};
  return WriteJson(a.json, json.size() == 1 ? json.front() : nlohmann::json{{"machines", json}});
}

}  // namespace

void AddCompareCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand(
      "compare", "Measured against modelled flow: error beside sensor noise, and where the model fails");
  command->add_option("LOG", a->logs, "Logs of one machine (CSV, CSV.gz or MAT)");
  command->add_option("--hold-out", a->hold_out,
                      "Log the model is not fitted to: its error on it is given as well");
  command->add_option("--machine,-m", a->machine,
                      "Machine file (TOML); with --db the model stored there if it is not given");
  AddHistoryOptions(*command, a->history);
  AddJsonOption(*command, a->json);
  command->add_option("--csv", a->csv, "Machines with [states]: write measured beside simulated, row by row");
  command->footer(
      "Examples:\n"
      "  hydroscope compare press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope compare press.csv -m machines/die_cushion.toml --json -\n"
      "  hydroscope compare X-ring257_*bar.csv -m machines/seal_friction.toml --hold-out X-ring257_3bar.csv\n"
      "  hydroscope compare --db press.db --from run:3");
  RunsAs(*command, exit_code, [a] { return RunCompare(*a); });
}

}  // namespace hydroscope
