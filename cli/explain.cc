#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/loop_explain.h"
#include "host/output.h"
#include "models/counted_words.h"
#include "report/explain_report.h"
#include "workbench/explain/explain_output.h"
#include "workbench/history/history_options.h"
#include "workbench/history/history_output.h"
#include "workbench/history/stored_change.h"
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
  const auto machine = LoadMachine(a.machine);
  if (!machine) return tl::unexpected(machine.error());
  auto measured = MeasuredSizes(a.measured, *machine);
  if (!measured) return tl::unexpected(measured.error());
  ExplainOptions options;
  options.measured = std::move(*measured);
  auto result = ExplainLogs(a.logs, a.machine, options);
  if (!result) return tl::unexpected(result.error());
  Explained out;
  const std::string text = ExplainText(*result);
  nlohmann::json json = ExplainJson(*result);
  Add(out, text, std::move(json), std::move(*result));
  return out;
}

/// All strokes chosen as one; `note` is what should be known of them, `found` the same as JSON.
Status ExplainWhole(const ExplainArguments& a, const Database& database, const HistoryChoice& choice,
                    const std::string& note, const nlohmann::json& found, Explained& out) {
  const auto history = LoadHistory(database, a.history.db, choice.parts, choice.machine);
  if (!history) return tl::unexpected(history.error());
  auto result = ExplainHistory(*history);
  if (!result) return tl::unexpected(result.error());
  result->described = HistoryLine(*history);
  result->target = choice.target;
  if (const HistoryPart& part = choice.parts.front(); a.whole && choice.parts.size() == 1)
    if (const auto change =
            FindStoredChange(database, part, choice.machine, AlarmsBeside(a.history.db, part.machine)))
      result->explanation.warnings.push_back(WarningOfBothSides(*change, CountedWordsOf(choice.machine)));
  const std::string text = note + ExplainText(*result);
  nlohmann::json json = HistoryJson(*history, *result);
  json["change_found"] = found;
  Add(out, text, std::move(json), std::move(*result));
  return {};
}

/// The strokes before against those after.
Status ExplainSides(const HistoryChoice& choice, const StrokeHistory& before, const StrokeHistory& after,
                    const std::string& note, const nlohmann::json& found, Explained& out) {
  auto result = ExplainChange(before, after);
  if (!result) return tl::unexpected(result.error());
  result->before.described = HistoryLine(before);
  result->after.described = HistoryLine(after);
  result->after.target = choice.target;
  const std::string text = note + ChangeText(*result);
  nlohmann::json json = ChangeJson(before, after, *result);
  json["change_found"] = found;
  Add(out, text, std::move(json), std::move(result->after));
  return {};
}

/// Strokes on either side of a change that nobody asked for.
Status ExplainFound(const ExplainArguments& a, const Database& database, const HistoryChoice& choice,
                    const StoredChange& change, Explained& out) {
  const nlohmann::json found = {{"since", change.since},
                                {"before_end", change.before_end},
                                {"by", change.by},
                                {"text", change.text.english}};
  const std::string lead =
      fmt::format("These {} hold a change {}.\n", CountedWordsOf(choice.machine).many, change.text.english);
  std::vector<HistoryPart> before = choice.parts, after = choice.parts;
  before.front().last = change.before_end;
  after.front().first = change.since;
  const auto then = LoadHistory(database, a.history.db, before, choice.machine);
  const auto now = LoadHistory(database, a.history.db, after, choice.machine);
  const Status compared =
      !then  ? tl::unexpected(then.error())
      : !now ? tl::unexpected(now.error())
             : ExplainSides(
                   choice, *then, *now,
                   lead + fmt::format("What changed there, as --since {} tells it (--whole explains all "
                                      "{} as one):\n\n",
                                      change.since, CountedWordsOf(choice.machine).many),
                   found, out);
  if (compared) return {};
  return ExplainWhole(
      a, database, choice,
      lead +
          fmt::format("They could not be compared ({}); explained as one, so before and after are mixed:\n\n",
                      compared.error().text),
      found, out);
}

Result<Explained> ExplainDatabase(const ExplainArguments& a) {
  const auto chosen = OpenHistory(a.history, a.machine);
  if (!chosen) return tl::unexpected(chosen.error());
  Explained out;
  for (const HistoryChoice& choice : chosen->choices) {
    Status done;
    if (!a.since.empty()) {
      const auto sides = Split(chosen->database, a.history.db, choice, a.since);
      done = sides ? ExplainSides(choice, sides->first, sides->second, "", nullptr, out)
                   : Status(tl::unexpected(sides.error()));
    } else {
      const HistoryPart& part = choice.parts.front();
      const auto change = a.whole || choice.parts.size() > 1
                              ? std::nullopt
                              : FindStoredChange(chosen->database, part, choice.machine,
                                                 AlarmsBeside(a.history.db, part.machine));
      done = change ? ExplainFound(a, chosen->database, choice, *change, out)
                    : ExplainWhole(a, chosen->database, choice, "", nullptr, out);
    }
    if (!done) return tl::unexpected(done.error());
  }
  if (out.results.size() > 1) out.json = {{"machines", std::move(out.json)}};
  return out;
}

Status ExplainStatesOfLogs(const ExplainArguments& a) {
  if (!a.report.empty())
    return UsageError("explain --report has no page for machines with [states] yet; use the text or --json");
  const auto explained = ExplainStatesLogs(a.logs, a.machine);
  if (!explained) return tl::unexpected(explained.error());
  if (a.json != "-") Say(ExplainText(*explained));
  return a.json.empty() ? Status() : WriteJson(a.json, ExplainJson(*explained));
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
    return ExplainClosedLoop(a.logs.front(), a.since, a.machine, a.json);
  }
  if (!a.since.empty() && a.history.db.empty()) return UsageError("--since needs --db DATABASE");
  if (a.history.db.empty() && HasStates(a.machine)) {
    if (!a.measured.empty())
      return UsageError("--measured: a machine described by states has no effects of the library");
    return ExplainStatesOfLogs(a);
  }
  auto explained = a.history.db.empty() ? ExplainOneLog(a) : ExplainDatabase(a);
  if (!explained) return tl::unexpected(explained.error());
  if (a.json != "-") Say(explained->text);
  if (!a.report.empty())
    if (const Status written = WriteExplainReport(a.report, explained->results); !written) return written;
  return a.json.empty() ? Status() : WriteJson(a.json, explained->json);
}

}  // namespace

void AddExplainCommand(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<ExplainArguments>();
  CLI::App* command = app.add_subcommand(
      "explain", "Which physical effect the model misses: verdict, evidence and what to do next");
  command->add_option("logs", a->logs,
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
  command->add_option("--json", a->json, "Write the result as JSON to this file; - is stdout");
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
  command->callback([a, &exit_code] {
    if (const Status done = RunExplain(*a); !done) exit_code = ReportError(done.error());
  });
}

}  // namespace hydroscope
