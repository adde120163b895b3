#include "live/surveillance.h"

#include "core/told_error.h"
#include "live/log.h"
#include "monitor/promoted_model.h"
#include "pipeline/doubtful_estimates.h"
#include "pipeline/geometry_tolerance.h"

namespace hydroscope {

Surveillance::Surveillance(LiveService& service, ValveChecks& checks, const LiveOptions& options, Clock clock)
    : service_(service),
      checks_(checks),
      options_(options),
      clock_(std::move(clock)),
      machine_(service.machine()) {
  Begin();
}

Surveillance::~Surveillance() { Stop(); }

/// Of an axis that is its own press, that axis.
std::string Surveillance::press() const {
  return AxisCount(machine_) > 1 ? machine_.name : AxisMachineName(machine_, 0);
}

void Surveillance::Begin() {
  auto press_monitor = MakePressMonitor();  // pairs journal and database
  if (press_monitor)
    for (const PressMonitor::Notice& notice : press_monitor->notices())
      LogWarning(notice.event, {{"why", notice.text}});
  const std::string journal = AlarmJournal::PathFor(options_.database);
  std::lock_guard lock(mutex_);
  journal_ = FileIdentity::Of(journal);
  logs_beside_.emplace(std::vector<std::string>{options_.database, journal});
  if (!log_) log_.emplace(journal);
  feeds_.emplace(Feeds::Start(machine_, options_.database, clock_, board_));
  self_.emplace(journal, press(), *board_);
  if (press_monitor)
    watch_ = std::make_unique<DriftWatch>(std::move(press_monitor),
                                          DriftWatch::Inputs{[this] { return service_.status(); },
                                                             [this] { return checks_.checking(); }, board_},
                                          clock_);
}

/// Judges by the models in force; where one that was promoted cannot be used, which the service tells, by the machine file's.
Result<std::unique_ptr<PressMonitor>> Surveillance::MakeJudge() const {
  std::vector<Machine> axes = MachinesOfAxes(machine_);
  if (auto database = Database::Open(options_.database))
    if (auto stored = StoredAxes(options_.database, machine_, *database);
        stored && stored->size() == axes.size())
      axes = std::move(*stored);
  for (const Machine& axis : axes)  // the rest of it needs strokes (DriftWatch)
    if (const auto model = BuildModel(axis))
      board_->TellStatements(axis.name, ToleranceStatements(axis, **model));
  return PressMonitor::Create(options_.machine_file, machine_.name, std::move(axes), options_.database);
}

/// nullptr, with the reason in `not_watched_`, if the model's parameters cannot be watched or journal or rules
/// are unusable: the strokes are stored all the same and can be judged later.
std::unique_ptr<PressMonitor> Surveillance::MakePressMonitor() {
  auto press_monitor = MakeJudge();
  const Status usable =
      press_monitor ? (*press_monitor)->watchable() : Status(tl::unexpected(press_monitor.error()));
  std::lock_guard lock(mutex_);
  not_watched_ = usable ? Told() : ToldOf(usable.error());
  if (usable) return std::move(*press_monitor);
  LogError("drift_is_not_watched", {{"why", not_watched_.english}});
  return nullptr;
}

void Surveillance::Start() {
  watching_ = true;
  if (watch_) watch_->Start();
}

void Surveillance::BeginAnew(const Told& why) {
  std::unique_ptr<DriftWatch> watch;
  std::optional<Feeds> feeds;
  {
    std::lock_guard lock(mutex_);
    watch = std::move(watch_);
    feeds = std::exchange(feeds_, std::nullopt);
    self_.reset();
    log_.reset();
  }
  watch.reset();
  feeds.reset();
  Begin();
  if (watching_ && watch_) watch_->Start();
  self_->BegunAnew(why, Seconds(clock_().wall_ns));
}

bool Surveillance::Look() {
  const LiveStatus now = status();
  const bool writes = now.writer.state == WriterState::kWriting;
  if (writes && now.writer.databases != databases_) {
    databases_ = now.writer.databases;
    BeginAnew(now.writer.begun_anew);
  } else if (writes && journal_.exists() &&
             FileIdentity::Of(AlarmJournal::PathFor(options_.database)) != journal_) {
    LogError("journal_gone", {{"why", "it was deleted, moved or replaced; another one is begun"}});
    BeginAnew(
        {"the alarm journal was deleted, moved or replaced while in use: its rows and references are lost",
         "das Alarmbuch wurde im Betrieb gelöscht, verschoben oder ersetzt: seine Zeilen und Referenzen sind "
         "verloren"});
  }
  self_->Look(now.writer, WhyNotJudged(), Seconds(clock_().wall_ns));
  log_->Look(now);
  const std::string gone = writes ? logs_beside_->Gone() : "";
  if (!gone.empty())
    LogError("begins_again",
             {{"why", gone + " was deleted or replaced while in use: others do not see what is written"}});
  return gone.empty();
}

void Surveillance::Reload(const Machine& machine) {
  machine_ = machine;
  if (!watch_) return;
  if (auto press_monitor = MakePressMonitor()) watch_->Replace(std::move(press_monitor));
}

void Surveillance::Stop() {
  if (watch_) watch_->Stop();
}

void Surveillance::Finish() {
  if (watch_) watch_->Finish();
}

Told Surveillance::WhyNotJudged() const {
  std::lock_guard lock(mutex_);
  return watch_ ? watch_->status().problem : not_watched_;
}

/// Health of each axis, and how its estimates are stated, are what the feeds read: those of the board.
DriftWatchStatus Surveillance::Drift() const {
  DriftWatchStatus drift;
  drift.problem = WhyNotJudged();
  std::lock_guard lock(mutex_);
  if (watch_) drift.axes = watch_->status().axes;
  for (int axis = 0; !watch_ && axis < AxisCount(machine_); ++axis)
    drift.axes.push_back({.name = AxisMachineName(machine_, axis), .health = {}, .alarms = {}});
  for (AxisHealth& axis : drift.axes) {
    axis.health = board_->Of(axis.name);
    axis.statements = board_->StatementsOf(axis.name);
  }
  return drift;
}

LiveStatus Surveillance::status() const {
  LiveStatus now = service_.status();
  now.drift = Drift();
  for (AxisStatus& axis : now.axes) {
    for (Estimate& estimate : axis.estimates) StateEstimate(board_->StatementsOf(axis.name), estimate);
    AddDoubts(DoubtsOf(machine_, axis.estimates), axis.warnings);
  }
  now.valve_check = checks_.state();
  now.log = NewestLogLines();
  std::lock_guard lock(mutex_);
  if (feeds_) now.feeds = feeds_->status();
  return now;
}

}  // namespace hydroscope
