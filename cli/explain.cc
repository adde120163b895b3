#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/command_answer.h"
#include "cli/commands.h"
#include "cli/old_database.h"
#include "host/output.h"
#include "models/counted_words.h"
#include "report/explain_report.h"
#include "report/states_report.h"
#include "workbench/explain/explain_output.h"
#include "workbench/explain/explain_stored.h"
#include "workbench/frequency_response/loop_change.h"
#include "workbench/history/history_options.h"
#include "workbench/history/history_output.h"
#include "workbench/model/measured_sizes.h"
#include "workbench/states/states_output.h"

namespace hydroscope {
namespace {

struct ExplainArguments {
  std::vector<std::string> logs, measured;
  std::string machine, json, report, since;
  HistoryOptions history;
  bool whole = false;
};

/// What was explained: a text for people, JSON, and what the report is made of.
struct Explained {
  std::string text;
  nlohmann::json json;
  std::vector<ExplainResult> results;
};

void Add(Explained& all, const std::string& text, nlohmann::json json, ExplainResult result) {
  all.text += (all.text.empty() ? "" : "\n") + text;
  if (all.json.is_null())
    all.json = std::move(json);
  else if (all.json.is_object())
    all.json = nlohmann::json::array({std::move(all.json), std::move(json)});
  else
    all.json.push_back(std::move(json));
  all.results.push_back(std::move(result));
}

Result<Explained> ExplainOneLog(const ExplainArguments& a) {
  const auto machine = TRY(LoadMachine(a.machine));
  auto measured = TRY(MeasuredSizes(a.measured, machine));
  ExplainOptions options;
  options.measured = std::move(measured);
  auto result = TRY(ExplainLogs(a.logs, a.machine, options));
  Explained out;
  const std::string text = ExplainText(result);
  nlohmann::json json = ExplainJson(result);
  Add(out, text, std::move(json), std::move(result));
  return out;
}

nlohmann::json FoundJson(const std::optional<StoredChange>& change) {
  if (!change) return nullptr;
  return {{"since", change->since},
          {"before_end", change->before_end},
          {"by", change->by},
          {"text", change->text.english}};
}

void AddWhole(const std::string& note, const StrokeHistory& history,
              const std::optional<StoredChange>& change, ExplainResult result, Explained& out) {
  const std::string text = note + ExplainText(result);
  nlohmann::json json = HistoryJson(history, result);
  json["change_found"] = FoundJson(change);
  Add(out, text, std::move(json), std::move(result));
}

/// The strokes before against those after.
void AddSides(const std::string& note, const StrokeHistory& before, const StrokeHistory& after,
              const std::optional<StoredChange>& change, ChangeResult result, Explained& out) {
  const std::string text = note + ChangeText(result);
  nlohmann::json json = ChangeJson(before, after, result);
  json["change_found"] = FoundJson(change);
  Add(out, text, std::move(json), std::move(result.after));
}

/// All strokes chosen as one.
Status ExplainWhole(const ExplainArguments& a, const Database& database, const HistoryChoice& choice,
                    Explained& out) {
  const auto history = TRY(LoadHistory(database, a.history.db, choice.parts, choice.machine));
  auto result = TRY(ExplainHistoryButForOdd(history));
  result.described = HistoryLine(history);
  result.target = choice.target;
  if (const HistoryPart& part = choice.parts.front(); choice.parts.size() == 1) {
    auto change = FindStoredChange(database, part, choice.machine, AlarmsBeside(a.history.db, part.machine));
    if (!change && result.explanation.verdict == Verdict::kUnknown)
      change = FindMovingOn(database, part, choice.machine);
    if (change)
      result.explanation.warnings.push_back(WarningOfBothSides(*change, CountedWordsOf(choice.machine)));
  }
  AddWhole("", history, std::nullopt, std::move(result), out);
  return {};
}

/// Strokes on either side of a place that somebody names.
Status ExplainSince(const ExplainArguments& a, const Database& database, const HistoryChoice& choice,
                    Explained& out) {
  const auto sides = TRY(Split(database, a.history.db, choice, a.since));
  auto result = TRY(ExplainChange(sides.first, sides.second));
  result.before.described = HistoryLine(sides.first);
  result.after.described = HistoryLine(sides.second);
  result.after.target = choice.target;
  AddSides("", sides.first, sides.second, std::nullopt, std::move(result), out);
  return {};
}

/// Strokes of one machine, on either side of a change if they hold one.
Status ExplainPart(const ExplainArguments& a, const Database& database, const HistoryChoice& choice,
                   Explained& out) {
  const HistoryPart& part = choice.parts.front();
  auto stored = TRY(
      ExplainStored(database, a.history.db, part, choice.machine, AlarmsBeside(a.history.db, part.machine)));
  stored.now().target = choice.target;
  const CountedWords counted = CountedWordsOf(choice.machine);
  std::string note = ChangeSentence(stored, counted);
  if (stored.sides)
    note += fmt::format("\nWhat changed there, as --since {} tells it (--whole explains all {} as one):",
                        stored.change->since, counted.many);
  if (!note.empty()) note += "\n\n";
  if (stored.sides)
    AddSides(note, stored.before, stored.after, stored.change, std::move(*stored.sides), out);
  else
    AddWhole(note, stored.after, stored.change, std::move(*stored.whole), out);
  return {};
}

Result<Explained> ExplainDatabase(const ExplainArguments& a) {
  const auto chosen = TRY(OpenHistory(a.history, a.machine));
  SayIfOld(a.history.db);
  Explained out;
  for (const HistoryChoice& choice : chosen.choices) {
    const auto explain = !a.since.empty()                     ? ExplainSince
                         : a.whole || choice.parts.size() > 1 ? ExplainWhole
                                                              : ExplainPart;
    TRY(explain(a, chosen.database, choice, out));
  }
  if (out.results.size() > 1) out.json = {{"machines", std::move(out.json)}};
  return out;
}

Status ExplainStatesOfLogs(const ExplainArguments& a) {
  const auto explained = TRY(ExplainStatesLogs(a.logs, a.machine));
  if (a.json != "-") Say(ExplainText(explained));
  if (!a.report.empty()) TRY(WriteStatesReport(a.report, explained));
  return a.json.empty() ? Status() : WriteJson(a.json, ExplainJson(explained));
}

Status RunExplain(const ExplainArguments& a) {
  if (a.logs.empty() == a.history.db.empty())
    return UsageError("explain needs either a LOG with --machine, or --db DATABASE");
  if (a.history.db.empty() && a.machine.empty()) return UsageError("explain LOG needs --machine M.toml");
  if (!a.measured.empty() && a.logs.empty()) return UsageError("--measured needs a LOG");
  if (a.history.db.empty() && IsClosedLoop(a.machine)) {
    if (a.logs.size() > 1 || !a.report.empty() || !a.measured.empty())
      return UsageError(
          "explain of a machine in closed loop takes one LOG, and --since OLD for what "
          "changed; no --report, no --measured");
    const auto changed = TRY(ExplainLoopLog(a.logs.front(), a.since, a.machine));
    return Answer(LoopChangeText(changed), LoopChangeJson(changed), a.json);
  }
  if (!a.since.empty() && a.history.db.empty()) return UsageError("--since needs --db DATABASE");
  if (a.history.db.empty() && HasStates(a.machine)) {
    if (!a.measured.empty())
      return UsageError("--measured: a machine described by states has no effects of the library");
    return ExplainStatesOfLogs(a);
  }
  auto explained = TRY(a.history.db.empty() ? ExplainOneLog(a) : ExplainDatabase(a));
  if (a.json != "-") Say(explained.text);
  if (!a.report.empty()) TRY(WriteExplainReport(a.report, explained.results));
  return a.json.empty() ? Status() : WriteJson(a.json, explained.json);
}

}  // namespace

void AddExplainCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<ExplainArguments>();
  CLI::App* command = app.add_subcommand(
      "explain", "Which physical effect the model misses: verdict, evidence and what to do next");
  command->add_option("LOG", a->logs,
                      "Logs of one machine, their strokes or episodes summed (CSV, CSV.gz or MAT)");
  command->add_option("--machine,-m", a->machine,
                      "Machine file (TOML); with --db the model stored there if it is not given");
  AddHistoryOptions(*command, a->history);
  command->add_option(
      "--since", a->since,
      "What changed at this stroke or episode, log (run:3), time (81.5s) or date; with --db. Of a machine in "
      "closed loop: against this log");
  command->add_flag(
      "--whole", a->whole,
      "With --db: all strokes or episodes as one, also where they hold a change that stands out");
  command->add_option(
      "--measured", a->measured,
      "Size of an effect that a test off the log gave, EFFECT=SIZE:STANDARD_ERROR in the unit "
      "in which explain shows it; 0 says that it is not there");
  command->add_option("--report,-r", a->report, "Write the explanation as one HTML page to this file");
  AddJsonOption(*command, a->json);
  command->footer(
      "Verdicts: adequate, named, ambiguous, unknown (docs/workbench.md). The exit code is 0 for all four.\n"
      "Examples:\n"
      "  hydroscope explain press.csv --machine machines/die_cushion.toml --report press.html\n"
      "  hydroscope explain press.csv --machine press.toml --measured pressure_offset=6.5:0.1\n"
      "  hydroscope explain X-ring257_*bar.csv --machine machines/seal_friction.toml\n"
      "  hydroscope explain --db press.db --from run:3\n"
      "  hydroscope explain --db press.db --since 1200 --json -\n"
      "  hydroscope explain --db works.db --fleet\n"
      "  hydroscope explain today.csv -m machines/test_cylinder.toml --since march.csv");
  RunsAs(*command, exit_code, [a] { return RunExplain(*a); });
}

}  // namespace hydroscope
