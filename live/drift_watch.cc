#include "live/drift_watch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "alarms/press_health.h"
#include "core/clock.h"
#include "core/printable.h"
#include "core/told_error.h"
#include "live/log.h"

namespace hydroscope {
namespace {

constexpr std::chrono::milliseconds kWatchRound(100);
constexpr std::chrono::milliseconds kAfterError(2000);  // until the next try
constexpr int kNice = 10;                     ///< strokes that are stored can wait, those that end cannot
constexpr double kLookEvery = 0.5;            ///< s between looks at channels
constexpr double kSilence = 2.0;              ///< s a channel may be stale before that is told
constexpr double kStart = 15.0;               ///< s after the start in which senders may be found
constexpr double kIdle = 60.0;                ///< s without a stroke
constexpr double kShareForStatements = 0.05;  ///< of a core, for how estimates are stated
constexpr AlarmSettings kAtOnce{1, 1, 0, false};

double Wall(HostTime now) { return Seconds(now.wall_ns); }

using Names = std::vector<std::string>;
Told NothingComes(const Names& channels) {
  return Tell(
      "no samples of {}: check the controller and the link to it; `hydroscope check --live` shows every channel",
      "keine Werte von {}: die Steuerung und die Verbindung zu ihr prüfen; `hydroscope check --live` zeigt jeden Kanal",
      fmt::format("{}", fmt::join(channels, ", ")));
}
Told NothingOfUse(const Names& channels) {
  return Tell(
      "no usable samples of {}: they are no numbers, or outside min and max of the machine file; check the sensor and its cable",
      "keine brauchbaren Werte von {}: keine Zahlen oder außerhalb von min und max der Maschinendatei; "
      "den Sensor und sein Kabel prüfen",
      fmt::format("{}", fmt::join(channels, ", ")));
}
Told AtAnotherRate(const Names& channels) {
  return Tell(
      "samples of {} come, but not at the rate of [live] grid_period, and nothing is identified: change the sender or the "
      "machine file; `hydroscope check --live` shows the rate of every channel",
      "Werte von {} kommen, aber nicht im Takt von [live] grid_period, und nichts wird identifiziert: den Sender oder die "
      "Maschinendatei ändern; `hydroscope check --live` zeigt den Takt jedes Kanals",
      fmt::format("{}", fmt::join(channels, ", ")));
}

}  // namespace

DriftWatch::DriftWatch(std::unique_ptr<PressMonitor> press, Inputs inputs, Clock clock)
    : press_(std::move(press)),
      inputs_(std::move(inputs)),
      clock_(std::move(clock)),
      axes_(static_cast<std::size_t>(press_->axis_count())) {
  for (Axis& axis : axes_) axis.changed = clock_().monotonic_ns;
}

void DriftWatch::Start() {
  thread_ = std::thread([this] { Run(); });
}

void DriftWatch::Stop() {
  if (!thread_.joinable()) return;
  {
    std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void DriftWatch::Finish() { Publish(press_->CatchUp(Wall(clock_()))); }

void DriftWatch::Replace(std::unique_ptr<PressMonitor> press) {
  std::lock_guard lock(mutex_);
  replacement_ = std::move(press);
}

void DriftWatch::Run() {
  static_cast<void>(nice(kNice));  // of this thread alone
  for (;;) {
    {
      std::lock_guard lock(mutex_);
      if (stop_) return;
      if (replacement_) {
        press_ = std::move(replacement_);
        for (Axis& axis : axes_) axis.idle = axis.checked = false, axis.stated = -1;  // said anew
      }
    }
    const HostTime now = clock_();
    Status done = press_->CatchUp(Wall(now));
    if (done && Seconds(now.monotonic_ns - looked_) >= kLookEvery) {
      looked_ = now.monotonic_ns;
      done = Look(now);
    }
    Publish(done);
    if (done) StateNext(now);
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, done ? kWatchRound : kAfterError, [this] { return stop_; });
  }
}

Status DriftWatch::Look(HostTime now) {
  TRY(press_->Tick(Wall(now)));
  const LiveStatus live = inputs_.status();
  for (int a = 0; a < press_->axis_count(); ++a) TRY(LookAtAxis(a, live, now));
  return {};
}

Status DriftWatch::LookAtAxis(int index, const LiveStatus& live, HostTime now) {
  Axis& axis = axes_[static_cast<std::size_t>(index)];
  const std::int64_t strokes = live.axes[static_cast<std::size_t>(index)].strokes;
  if (strokes != axis.strokes) axis.changed = now.monotonic_ns;
  axis.strokes = strokes;
  const bool idle = Seconds(now.monotonic_ns - axis.changed) > kIdle;
  const bool checked = inputs_.checked_axis() == index;
  if (idle != axis.idle) {
    TRY(press_->axis(index).SetSuppression(kSuppressedIdle, idle, Wall(now)));
    axis.idle = idle;
  }
  if (checked != axis.checked) {
    TRY(press_->axis(index).SetSuppression(kSuppressedValveCheck, checked, Wall(now)));
    axis.checked = checked;
  }
  TRY(LookForSecondSender(index, live, now));
  return LookForSilence(index, live, now);
}

/// Raises an alarm of the axis, or clears it without a condition; nothing is written while nothing changes.
Status DriftWatch::Tell(int index, const char* alarm, const std::optional<AlarmCondition>& condition,
                        HostTime now) {
  const auto& alarms = press_->axis(index).alarms();
  const bool stands = std::any_of(alarms.begin(), alarms.end(),
                                  [&](const AlarmState& a) { return a.id == alarm && a.active; });
  if (stands == condition.has_value()) return {};
  return press_->axis(index).Observe(alarm, kAtOnce, condition, Wall(now));
}

/// "two_senders": somebody else sends channels of the axis as well. Which of them speaks of the machine nobody
/// here can know, so that this is a loss of signal, though the first one goes on being believed.
Status DriftWatch::LookForSecondSender(int index, const LiveStatus& live, HostTime now) {
  const auto name = [](const SenderStatus& sender) {
    return fmt::format("{} (session {})", sender.name.empty() ? "a sender" : Printable(sender.name),
                       sender.id.session);
  };
  std::vector<std::string> first, others;
  std::set<int> sources;  // slow channels of another source are not what this is about
  for (const SenderStatus& sender : live.senders)
    if (sender.refused_axes.contains(index)) {
      others.push_back(name(sender));
      sources.insert(sender.id.source);
    }
  for (const SenderStatus& sender : live.senders)
    if (sender.axes.contains(index) && sources.contains(sender.id.source)) first.push_back(name(sender));
  if (others.empty()) return Tell(index, "two_senders", std::nullopt, now);
  AlarmCondition condition;
  condition.value = static_cast<double>(1 + others.size());
  condition.limit = 2;
  condition.unit = "1";
  condition.severity = AlarmSeverity::kSignalLoss;
  condition.Say(hydroscope::Tell(
      "two senders of the same channels: {} was first and is believed, {} is left out; switch off the one "
      "that is not this machine's, `hydroscope status` shows both",
      "zwei Sender derselben Kanäle: {} war zuerst da und gilt, {} bleibt außen vor; den abschalten, der nicht zu "
      "dieser Maschine gehört, `hydroscope status` zeigt beide",
      fmt::format("{}", fmt::join(first, ", ")), fmt::format("{}", fmt::join(others, ", "))));
  return Tell(index, "two_senders", condition, now);
}

/// "no_samples": channels the model cannot do without have been stale for longer than kSilence, or come and are of no use.
Status DriftWatch::LookForSilence(int index, const LiveStatus& live, HostTime now) {
  Axis& axis = axes_[static_cast<std::size_t>(index)];
  std::vector<std::string> there, stale, never, unusable;
  for (const ChannelStatus& channel : live.channels)
    if (channel.axis == index && channel.required)
      (!std::isfinite(channel.age) ? never
       : channel.stale             ? stale
       : channel.usable            ? there
                                   : unusable)
          .push_back(channel.name);
  if (live.uptime > kStart) stale.insert(stale.end(), never.begin(), never.end());
  const std::int64_t rows = live.axes[static_cast<std::size_t>(index)].counters.rows;
  const bool no_rows = std::exchange(axis.rows, rows) == rows && never.empty();
  if (stale.empty() && unusable.empty() && !no_rows) {
    axis.silent_since = 0;
    if (!never.empty()) return {};  // only samples clear it, a restart of the service does not
    return Tell(index, "no_samples", std::nullopt, now);
  }
  if (axis.silent_since == 0) axis.silent_since = now.monotonic_ns;
  const double seconds = Seconds(now.monotonic_ns - axis.silent_since);
  if (seconds < kSilence) return {};
  AlarmCondition condition;
  condition.value = seconds;
  condition.limit = kSilence;
  condition.unit = "s";
  condition.severity = AlarmSeverity::kSignalLoss;
  condition.Say(!stale.empty()      ? NothingComes(stale)
                : !unusable.empty() ? NothingOfUse(unusable)
                                    : AtAnotherRate(there));
  return Tell(index, "no_samples", condition, now);
}

/// Of one axis where it is due, as replay and `trends` state them; what cannot be read now stands as it was and is asked later.
void DriftWatch::StateNext(HostTime now) {
  if (!inputs_.board || now.monotonic_ns < state_after_) return;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    const std::size_t index = (state_from_ + k) % axes_.size();
    Axis& axis = axes_[index];
    if (axis.stated >= 0 && axis.strokes - axis.stated < AxisMonitor::kStrokesPerStatement) continue;
    const AxisMonitor& monitor = press_->axis(static_cast<int>(index));
    if (auto statements = monitor.Statements())
      inputs_.board->TellStatements(monitor.name(), std::move(*statements));
    axis.stated = axis.strokes;
    state_from_ = index + 1;
    const std::int64_t after = clock_().monotonic_ns;
    state_after_ = after + static_cast<std::int64_t>(static_cast<double>(after - now.monotonic_ns) /
                                                     kShareForStatements);
    return;
  }
}

void DriftWatch::Publish(const Status& done) {
  DriftWatchStatus status;
  if (!done) status.problem = ToldOf(done.error());
  const auto standing = [](const std::vector<AlarmState>& alarms) {
    std::vector<std::string> names;
    for (const AlarmState& alarm : alarms)
      if (!AtRest(alarm)) names.push_back(fmt::format("{} {}", StateName(alarm), alarm.id));
    return names;
  };
  for (int a = 0; a < press_->axis_count(); ++a) {
    const AxisMonitor& axis = press_->axis(a);
    AxisHealth health{axis.name(),
                      axis.JudgedHealth(),
                      0,
                      axis.commissioning_strokes(),
                      press_->rules().commissioning,
                      axis.next_stroke(),
                      standing(axis.alarms())};
    if (axis.monitor() != nullptr) health.reference = axis.monitor()->reference().version();
    status.axes.push_back(std::move(health));
  }
  if (!press_->alarms().empty()) {
    std::vector<Health> axes;
    for (const AxisHealth& axis : status.axes) axes.push_back(axis.health);
    status.axes.push_back({press_->name(), JudgePressHealth(press_->alarms(), {}, axes), 0, 0, 0, 0,
                           standing(press_->alarms())});
  }
  if (inputs_.board)
    for (const AxisHealth& axis : status.axes) inputs_.board->TellAxis(axis.name, axis.health);
  std::lock_guard lock(mutex_);
  if (status.problem != status_.problem) {
    if (status.problem.empty())
      LogInfo("judging_again");
    else
      LogWarning("cannot_judge", {{"why", status.problem.english}});
  }
  status_ = std::move(status);
}

DriftWatchStatus DriftWatch::status() const {
  std::lock_guard lock(mutex_);
  return status_;
}

}  // namespace hydroscope
