#include "review/replay_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/contains.h"
#include "core/counted_words.h"
#include "core/interval_text.h"
#include "core/json_value.h"
#include "core/shell_word.h"
#include "core/short_number.h"
#include "core/units.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "workbench/explain/headline.h"
#include "workbench/fit_output.h"

namespace hydroscope {
namespace {

constexpr std::size_t kFindingsShown = 3;

std::string Capitals(std::string_view word) {
  std::string text(word);
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string StatusText(const LogReplay& replay, const CountedWords& counted) {
  switch (replay.status) {
    case ReplayStatus::kReplayed:
      return "replayed";
    case ReplayStatus::kContinued:
      return fmt::format("continued ({} {} were there)", replay.stored_before, counted.many);
    case ReplayStatus::kAlready:
      return "already replayed";
    case ReplayStatus::kFailed:
      return "LEFT OUT";
  }
  return "";
}

std::string Percent(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? fmt::format("{:.1f} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole))
                   : "-";
}

std::string LogTable(const ReplayOutcome& outcome) {
  const CountedWords counted = CountedWordsOf(outcome.machine);
  std::size_t width = 3;
  for (const LogReplay& r : outcome.logs) width = std::max(width, r.log.size());
  std::string text = fmt::format("{:<{}} {:>10} {:>8} {:>8} {:>9} {:>9}  {}\n", "log", width, "rows",
                                 counted.many, "used", "rejected", "flagged", "");
  for (const LogReplay& r : outcome.logs) {
    if (r.status == ReplayStatus::kFailed)
      text += fmt::format("{:<{}} {:>10} {:>8} {:>8} {:>9} {:>9}  {}\n", r.log, width, "-", "-", "-", "-",
                          "-", StatusText(r, counted));
    else
      text += fmt::format("{:<{}} {:>10} {:>8} {:>8} {:>9} {:>9}  {}\n", r.log, width, r.summary.rows,
                          r.run.strokes, Percent(r.summary.used, r.summary.rows), r.summary.rejected_rows,
                          r.summary.FlaggedValues(), StatusText(r, counted));
  }
  return text;
}

/// Whether a note on one of the logs says so.
bool IsNoted(const ReplayOutcome& outcome, const std::string& sentence) {
  return std::ranges::any_of(outcome.logs,
                             [&](const LogReplay& log) { return Contains(log.notes, sentence); });
}

std::string Troubles(const ReplayOutcome& outcome) {
  std::string text;
  for (const LogReplay& r : outcome.logs) {
    for (const std::string& note : r.notes) text += fmt::format("note: {}: {}\n", r.log, note);
    if (r.status == ReplayStatus::kFailed) {
      text += fmt::format("LEFT OUT: {}\n", r.problem);
      continue;
    }
    if (!r.summary.stopped.empty())
      text +=
          fmt::format("PARTLY: {}: read up to row {}, then: {}\n", r.log, r.summary.rows, r.summary.stopped);
    if (r.summary.rejected_rows > 0) {
      text +=
          fmt::format("PARTLY: {}: {} could not be read\n", r.log, Counted(r.summary.rejected_rows, "row"));
      for (std::size_t i = 0; i < std::min(kFindingsShown, r.summary.findings.size()); ++i)
        text += "  " + FindingText(r.summary.findings[i]) + "\n";
    }
    if (r.run.strokes == 0)
      text += fmt::format(
          "NO {}: {}: {} of {} rows inside the gate; look at it with: hydroscope check {} --machine M.toml\n",
          Capitals(CountedWordsOf(outcome.machine).one), r.log, r.summary.gated, r.summary.rows, r.log);
    if (!r.taught_nothing.empty())
      text += fmt::format("NOTHING LEARNED: {}: {}; look at it with: hydroscope check {} --machine M.toml\n",
                          r.log, r.taught_nothing, r.log);
  }
  return text.empty() ? text : "\n" + text;
}

std::string ParameterTable(const ReplayOutcome& outcome) {
  if (outcome.latest.empty())
    return fmt::format("\nNo parameter is identified yet: it takes one {} or more with enough equations.\n",
                       WordsOf(outcome.machine).stroke.english);
  const CountedWords counted = CountedWordsOf(outcome.machine);
  std::string text =
      fmt::format("\nafter {} {} of this machine, counted from 0 ({} of {} in the database)\n", counted.one,
                  outcome.strokes - 1, counted.Counted(outcome.strokes), Counted(outcome.runs.size(), "log"));
  text += fmt::format("{:<8} {:>12} {:>26}  {}\n", "", "value", "95 % interval", "unit");
  for (const Estimate& e : outcome.latest) {
    const DisplayUnit unit = ParameterUnit(KindOf(outcome.machine), e.parameter, e.unit);
    const Confounding* confounding = FindConfounding(outcome.stated.confounded, e.parameter);
    const bool confounded = confounding != nullptr && e.reason == EstimateReason::kConfounded;
    const int digits = DigitsFor(e.value, kNormal95 * e.std);
    const auto shown = [&](double si) { return ShortNumber(si * unit.factor + unit.offset, digits); };
    text += fmt::format("{:<8} {:>12} {:>12} ... {:<9}  {:<6}{}\n", e.parameter, shown(e.value),
                        shown(e.value - kNormal95 * e.std), shown(e.value + kNormal95 * e.std), unit.name,
                        confounded ? fmt::format(" NOT IDENTIFIABLE: {}; {}", confounding->reason.english,
                                                 confounding->advice.english)
                        : e.reason == EstimateReason::kUpdated ? ""
                                                               : fmt::format(" {}", ReasonText(e.reason)));
  }
  for (const Told& unusual : outcome.stated.unusual)
    if (!IsNoted(outcome, unusual.english)) text += fmt::format("WARNING: {}\n", unusual.english);
  for (const AssumedTolerance& assumed : outcome.stated.assumed) text += AssumedText(assumed) + "\n";
  const DisplayUnit unit = UnitOfErrors(outcome.machine);
  if (outcome.stated.figures.clusters.unit != ClusterUnit::kStroke)
    text += fmt::format("{} of the last run hang together: intervals are at least those of groups of them\n",
                        counted.many);
  if (outcome.stated.figures.noise_floor > 0)
    text += fmt::format("model error on {} left out {} {}, {} would cause {} {} (last run)\n", counted.many,
                        ShortNumber(outcome.stated.figures.rms_holdout * unit.factor), unit.name,
                        outcome.stated.floor_known
                            ? "sensor noise alone"
                            : "white noise (whether that of these sensors is white is not known)",
                        ShortNumber(outcome.stated.figures.noise_floor * unit.factor), unit.name);
  if (outcome.stated.figures.strokes > 0)
    if (const ModelHeadline headline = HeadlineOf(outcome.stated.figures, ErrorFinding::kNoise);
        headline.standing == ModelStanding::kNotJudged)
      text += headline.text + "\n";
  return text;
}

std::string SkippedTable(const ReplayOutcome& outcome) {
  std::string text;
  for (const SkippedItem& item : outcome.skipped)
    if (item.rows > 0) text += fmt::format("{:>12}  {:<34} {}\n", item.rows, item.what, item.why);
  return text.empty() ? text : "\nnot used, over all runs of this machine\n" + text;
}

std::string Next(const ReplayOptions& options, const ReplayOutcome& outcome) {
  std::string text =
      fmt::format("\ndatabase: {} ({} of \"{}\")\n", options.database,
                  CountedWordsOf(outcome.machine).Counted(outcome.strokes), outcome.machine.name);
  if (!outcome.report.empty())
    return text +
           fmt::format("report:   {}\nnext:     open {} in a browser\n", outcome.report, outcome.report);
  return text + fmt::format("next:     hydroscope trends --db {}\n", ShellWord(options.database));
}

nlohmann::json LogJson(const LogReplay& r) {
  nlohmann::json findings = nlohmann::json::array();
  for (const LogFinding& f : r.summary.findings)
    findings.push_back(
        {{"line", f.line}, {"column", f.column}, {"found", f.found}, {"expected", f.expected}});
  return {{"log", r.log},
          {"status", StatusName(r.status)},
          {"error", JsonOrNull(r.problem)},
          {"stopped", JsonOrNull(r.summary.stopped)},
          {"run", r.run.id},
          {"first_sequence", r.run.first_sequence},
          {"strokes", r.run.strokes},
          {"strokes_stored_before", r.stored_before},
          {"rows", r.summary.rows},
          {"rejected_rows", r.summary.rejected_rows},
          {"gated_rows", r.summary.gated},
          {"used_rows", r.summary.used},
          {"discarded_strokes", r.summary.discarded_strokes},
          {"taught_nothing", JsonOrNull(r.taught_nothing)},
          {"flagged", r.summary.flagged},
          {"absent", r.summary.absent},
          {"findings", findings},
          {"notes", r.notes}};
}

std::string AlarmTable(const std::vector<AlarmState>& alarms) {
  std::string text;
  for (const AlarmState& alarm : alarms)
    text += fmt::format("  {:<5} {:<11} {}: {}\n", StateName(alarm), SeverityName(alarm.severity), alarm.id,
                        alarm.text);
  return text;
}

/// What watching for drift says, with every alarm that stands.
std::string WatchText(const ReplayOptions& options, const WatchOutcome& watch, const CountedWords& counted) {
  if (!watch.problem.empty()) return "\nDrift is not watched: " + watch.problem + "\n";
  const std::string notice = watch.notice.empty() ? "" : "\nNote: " + watch.notice + "\n";
  if (watch.reference_version == 0)
    return notice + fmt::format("\nDrift: learning the healthy machine, {} of {} {}\n",
                                watch.commissioning_strokes, watch.commissioning_needed, counted.many);
  std::string text =
      notice + fmt::format("\nDrift: judged against reference {}; health (NAMUR NE 107): {} ({}); {}\n",
                           watch.reference_version, watch.health, watch.health_text,
                           watch.alarms.empty() ? "no alarm stands" : "alarms:");
  text += AlarmTable(watch.alarms);
  if (!watch.alarms.empty()) text += "  more: hydroscope alarms --db " + ShellWord(options.database) + "\n";
  return text;
}

nlohmann::json AlarmsJson(const std::vector<AlarmState>& standing) {
  nlohmann::json alarms = nlohmann::json::array();
  for (const AlarmState& a : standing)
    alarms.push_back({{"alarm", a.id},
                      {"state", StateName(a)},
                      {"severity", SeverityName(a.severity)},
                      {"text", a.text},
                      {"cause", CauseText(a.cause)},
                      {"cause_kind", CauseKindName(a.cause.kind)},
                      {"cause_effects", a.cause.effects},
                      {"raised_stroke", a.raised_stroke},
                      {"first_stroke", a.first_stroke},
                      {"last_stroke", a.last_stroke}});
  return alarms;
}

nlohmann::json WatchJson(const WatchOutcome& watch) {
  return {{"problem", watch.problem},
          {"reference_version", watch.reference_version},
          {"commissioning_strokes", watch.commissioning_strokes},
          {"commissioning_needed", watch.commissioning_needed},
          {"health", std::string(1, watch.health)},
          {"health_text", watch.health_text},
          {"notice", watch.notice},
          {"alarms", AlarmsJson(watch.alarms)}};
}

std::string TextOfMachine(const ReplayOptions& options, const ReplayOutcome& outcome) {
  return LogTable(outcome) + Troubles(outcome) + ParameterTable(outcome) +
         WatchText(options, outcome.watch, CountedWordsOf(outcome.machine)) + SkippedTable(outcome) +
         Next(options, outcome);
}

/// What the axes of the press show together.
std::string PressText(const PressReplay& replay) {
  if (replay.alarms.empty()) return "";
  return fmt::format("\nAxes of \"{}\" together:\n{}", replay.press, AlarmTable(replay.alarms));
}

nlohmann::json JsonOfMachine(const ReplayOptions& options, const ReplayOutcome& outcome) {
  nlohmann::json logs = nlohmann::json::array(), skipped = nlohmann::json::array();
  for (const LogReplay& log : outcome.logs) logs.push_back(LogJson(log));
  for (const SkippedItem& item : outcome.skipped)
    skipped.push_back({{"what", item.what}, {"rows", item.rows}, {"why", item.why}});
  const DisplayUnit unit = OutputUnit(outcome.machine);
  const GramFit& figures = outcome.stated.figures;
  const bool fitted = figures.strokes > 0 || figures.rms_holdout > 0 || figures.noise_floor > 0;
  const auto error = [&](double si) { return fitted ? nlohmann::json(si * unit.factor) : nlohmann::json(); };
  nlohmann::json parameters = ParametersJson(outcome.latest);
  AddConfoundings(outcome.stated.confounded, parameters);
  return {{"machine", outcome.machine.name},
          {"database", options.database},
          {"report", JsonOrNull(outcome.report)},
          {"complete", outcome.Complete()},
          {"logs", logs},
          {"runs", outcome.runs.size()},
          {"strokes", outcome.strokes},
          {"parameters", std::move(parameters)},
          {"assumed_tolerances", AssumedJson(outcome.stated.assumed)},
          {"warnings", InEnglish(outcome.stated.unusual)},
          {"watch", WatchJson(outcome.watch)},
          {"rms_holdout", error(figures.rms_holdout)},
          {"noise_floor", error(figures.noise_floor)},
          {"noise_floor_known", outcome.stated.floor_known},
          {"unit", unit.name},
          {"skipped", skipped}};
}

}  // namespace

std::string ReplayText(const ReplayOptions& options, const PressReplay& replay) {
  std::string text;
  for (const ReplayOutcome& outcome : replay.machines) {
    if (replay.machines.size() > 1)
      text += fmt::format("{}{}\n", text.empty() ? "" : "\n", outcome.machine.name);
    text += TextOfMachine(options, outcome);
  }
  return text + PressText(replay);
}

nlohmann::json ReplayJson(const ReplayOptions& options, const PressReplay& replay) {
  nlohmann::json document;
  if (replay.machines.size() == 1) {
    document = JsonOfMachine(options, replay.machines.front());
  } else {
    document = {{"database", options.database},
                {"complete", replay.Complete()},
                {"machines", nlohmann::json::array()}};
    for (const ReplayOutcome& outcome : replay.machines)
      document["machines"].push_back(JsonOfMachine(options, outcome));
  }
  if (!replay.press.empty())
    document["press"] = {{"machine", replay.press}, {"alarms", AlarmsJson(replay.alarms)}};
  return document;
}

}  // namespace hydroscope
