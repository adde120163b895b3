#include "review/replay_runner.h"

#include <algorithm>
#include <filesystem>

#include "host/output.h"
#include "host/real_clock.h"
#include "monitor/press_monitor.h"
#include "monitor/promoted_model.h"
#include "pipeline/axis_log.h"
#include "report/drift_report.h"
#include "review/axis_replay.h"

namespace hydroscope {
namespace {

/// "press.html" -> "press_cushion_1.html".
std::string ReportOfAxis(const std::string& report, const std::string& axis) {
  if (report.empty()) return "";
  const std::filesystem::path path(report);
  return path.parent_path() / (path.stem().string() + "_" + axis + path.extension().string());
}

/// What watching for drift says about one machine.
Status TakeWatch(const PressMonitor& press, const AxisMonitor& axis, bool for_report, WatchOutcome& watch) {
  watch.reference_version = axis.monitor() != nullptr ? axis.monitor()->reference().version() : 0;
  watch.commissioning_strokes = axis.commissioning_strokes();
  watch.commissioning_needed = press.rules().commissioning;
  watch.problem = axis.why_not_learned().english;
  watch.health = axis.Health();
  watch.health_text = axis.JudgedHealth().text;
  for (const PressMonitor::Notice& notice : press.notices())
    watch.notice += (watch.notice.empty() ? "" : "; ") + notice.text;
  for (const AlarmState& alarm : axis.alarms())
    if (!AtRest(alarm)) watch.alarms.push_back(alarm);
  if (!for_report) return {};
  watch.section_html = TRY(DriftSection(axis, press.rules().commissioning));
  watch.verdict_html = AlarmsBox(press.alarms(), axis.alarms(), axis.counted());
  return {};
}

/// Judges the strokes that are new in the database, as the live service does stroke by stroke.
Status WatchForDrift(const ReplayOptions& options, const Machine& machine, PressReplay& replay) {
  auto database = TRY(Database::Open(options.database));
  auto axes = TRY(StoredAxes(options.database, machine, database));
  const auto created =
      TRY(PressMonitor::Create(options.machine_file, machine.name, std::move(axes), options.database));
  PressMonitor& press = *created;
  if (const Status watchable = press.watchable(); !watchable) {
    for (ReplayOutcome& outcome : replay.machines) outcome.watch.problem = watchable.error().text;
    return {};
  }
  TRY(press.CatchUp(WallSeconds()));
  for (const AlarmState& alarm : press.alarms())
    if (!AtRest(alarm)) replay.alarms.push_back(alarm);
  for (ReplayOutcome& outcome : replay.machines)
    if (const AxisMonitor* axis = press.Find(outcome.machine.name))
      TRY(TakeWatch(press, *axis, !options.report.empty(), outcome.watch));
  return {};
}

}  // namespace

const char* StatusName(ReplayStatus status) {
  switch (status) {
    case ReplayStatus::kReplayed:
      return "replayed";
    case ReplayStatus::kContinued:
      return "continued";
    case ReplayStatus::kAlready:
      return "already_replayed";
    case ReplayStatus::kFailed:
      return "failed";
  }
  return "";
}

bool ReplayOutcome::Complete() const {
  return std::ranges::all_of(logs, [](const LogReplay& r) {
    return r.status != ReplayStatus::kFailed && r.run.strokes > 0 && r.summary.rejected_rows == 0 &&
           r.summary.stopped.empty() && r.taught_nothing.empty();
  });
}

bool ReplayOutcome::Failed() const {
  return std::ranges::all_of(logs, [](const LogReplay& r) { return r.status == ReplayStatus::kFailed; });
}

bool PressReplay::Complete() const {
  return std::ranges::all_of(machines, [](const ReplayOutcome& m) { return m.Complete(); });
}

bool PressReplay::Failed() const {
  return std::ranges::all_of(machines, [](const ReplayOutcome& m) { return m.Failed(); });
}

Result<PressReplay> RunReplay(const ReplayOptions& options) {
  const auto machine = TRY(LoadMachine(options.machine_file));
  const auto shares = TRY(ShareOutLogs(machine, options.logs, options.axis));
  if (const auto older = Database::OlderFormat(options.database))
    SayBeside(fmt::format(
        "{}: brought from format {} to the newest, in which a stroke is stored faster. Once, minutes if it "
        "holds many millions of estimates; stopping it leaves the file as it was\n",
        options.database, *older));
  PressReplay replay;
  if (HasNamedAxes(machine)) replay.press = machine.name;
  std::vector<std::unique_ptr<AxisReplay>> axes;
  for (const LogsOfAxis& share : shares) {
    auto database = TRY(Database::Open(options.database));
    const std::string report =
        shares.size() > 1 ? ReportOfAxis(options.report, machine.live->axes[share.axis]) : options.report;
    axes.push_back(std::make_unique<AxisReplay>(options, share, report, machine, std::move(database)));
    TRY(axes.back()->Store(replay.machines.emplace_back()));
  }
  TRY(WatchForDrift(options, machine, replay));
  for (std::size_t a = 0; a < axes.size(); ++a) {
    axes[a]->LookForChange(replay.machines[a]);
    TRY(axes[a]->Report(replay.machines[a]));
  }
  return replay;
}

}  // namespace hydroscope
