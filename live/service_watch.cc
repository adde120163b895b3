#include "live/service_watch.h"

#include <algorithm>

#include "alarms/alarm_machine.h"
#include "core/constants.h"

namespace hydroscope {
namespace {

constexpr AlarmSettings kTroubleAtOnce{1, 1, 0, false};

HealthReason ReasonOf(WriterState state) {
  switch (state) {
    case WriterState::kWriting:
      return HealthReason::kJudgedGood;
    case WriterState::kDiskFull:
      return HealthReason::kDiskFull;
    case WriterState::kLocked:
      return HealthReason::kDatabaseLocked;
    case WriterState::kGone:
      return HealthReason::kDatabaseGone;
    case WriterState::kDamaged:
    case WriterState::kFailing:
      break;
  }
  return HealthReason::kNotStored;
}

bool Stands(const AxisContent& content, const std::string& alarm) {
  return std::any_of(content.alarms.begin(), content.alarms.end(),
                     [&](const AlarmState& a) { return a.id == alarm && a.active; });
}

AlarmCondition ConditionOf(const ServiceTrouble& trouble) {
  AlarmCondition condition;
  condition.value = condition.limit = 1;
  condition.unit = "1";
  condition.severity = AlarmSeverity::kSignalLoss;
  condition.Say(trouble.text);
  return condition;
}

}  // namespace

ServiceTrouble TroubleOf(const WriterStatus& writer) {
  const HealthReason reason = ReasonOf(writer.state);
  if (reason == HealthReason::kJudgedGood) return {};
  return {reason, Tell("nothing is stored: {}", "nichts wird gespeichert: {}", writer.problem)};
}

ServiceTrouble NotWatched(const Told& why) {
  if (why.empty()) return {};
  return {HealthReason::kNotWatched, Tell("drift is not watched: {}", "Drift wird nicht überwacht: {}", why)};
}

void ServiceWatch::Look(const WriterStatus& writer, const Told& not_judged, double wall) {
  const ServiceTrouble storing = TroubleOf(writer), judging = NotWatched(not_judged);
  board_.TellTrouble(HealthBoard::Part::kStoring, storing);
  board_.TellTrouble(HealthBoard::Part::kJudging, judging);
  for (const auto& [alarm, trouble] : {std::pair("not_stored", storing), {"not_judged", judging}})
    if (!Observe(alarm, trouble, wall)) journal_.reset();  // tried again at the next look
}

void ServiceWatch::BegunAnew(const Told& why, double wall) {
  const ServiceTrouble lost{HealthReason::kNotStored, why};
  for (const ServiceTrouble& trouble : {lost, ServiceTrouble{}})
    if (!Observe("database_begun_anew", trouble, wall)) journal_.reset();
}

/// Nothing is written while nothing changes.
Status ServiceWatch::Observe(const std::string& alarm, const ServiceTrouble& trouble, double wall) {
  if (!journal_) {
    journal_ = TRY(AlarmJournal::OpenExisting(journal_path_));
  }
  const bool on = IsTrouble(trouble.reason);
  const auto content = TRY(journal_->Axis(press_));
  if (Stands(content, alarm) == on) return {};
  return journal_->Change(press_, wall, [&](AxisContent& press) -> Status {
    AlarmMoment now;
    now.wall = wall;
    now.time = now.oil_temperature = kNaN;
    AlarmState& state = press.Alarm(alarm);
    press.Append(on ? alarm_machine::Observe(state, kTroubleAtOnce, ConditionOf(trouble), now)
                    : alarm_machine::Clear(state, kTroubleAtOnce, now));
    return {};
  });
}

}  // namespace hydroscope
