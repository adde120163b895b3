#include "alarms/health.h"

#include <fmt/format.h>

namespace hydroscope {
namespace {

struct StateWords {
  char letter;
  const char* name;
};
constexpr std::array<StateWords, 5> kStates = {{{'-', "good"},
                                                {'M', "maintenance required"},
                                                {'S', "out of specification"},
                                                {'C', "function check"},
                                                {'F', "failure"}}};
constexpr std::array<const char*, 11> kReasons = {"judged_good",        "alarms",          "learning",
                                                  "strokes_not_judged", "out_of_service",  "nothing_known",
                                                  "disk_full",          "database_locked", "database_gone",
                                                  "not_stored",         "not_watched"};

HealthState StateOf(AlarmSeverity severity) {
  switch (severity) {
    case AlarmSeverity::kSignalLoss:
      return HealthState::kFailure;
    case AlarmSeverity::kAlarm:
      return HealthState::kOutOfSpecification;
    case AlarmSeverity::kWarning:
    case AlarmSeverity::kAdvisory:
      break;
  }
  return HealthState::kMaintenance;
}

/// The first of equally urgent answers stands.
void Worsen(Health& health, HealthState state, HealthReason reason, std::string text) {
  if (state <= health.state) return;
  health.state = state;
  health.reason = reason;
  health.text = std::move(text);
}

void TakeAlarms(const std::vector<AlarmState>& alarms, Health& health) {
  for (const AlarmState& alarm : alarms) {
    if (alarm.out_of_service)
      Worsen(health, HealthState::kFunctionCheck, HealthReason::kOutOfService,
             fmt::format("{} is out of service", alarm.id));
    else if (alarm.active && alarm.suppressed == 0)
      Worsen(health, StateOf(alarm.severity), HealthReason::kAlarms,
             fmt::format("{} stands ({})", alarm.id, SeverityName(alarm.severity)));
  }
}

std::string LearningText(const HealthEvidence& e) {
  if (!e.not_learned.empty()) return "nothing is judged: " + e.not_learned;
  if (e.learned >= e.needed)
    return fmt::format("nothing is judged: {} strokes wait for `hydroscope learn`", e.learned);
  return fmt::format("learning the healthy machine, {} of {} strokes", e.learned, e.needed);
}

}  // namespace

char HealthLetter(HealthState state) { return kStates[static_cast<std::size_t>(state)].letter; }
const char* HealthName(HealthState state) { return kStates[static_cast<std::size_t>(state)].name; }
const char* HealthReasonName(HealthReason reason) { return kReasons[static_cast<std::size_t>(reason)]; }
bool IsTrouble(HealthReason reason) { return reason >= HealthReason::kDiskFull; }

Health JudgeHealth(const HealthEvidence& e) {
  Health health{HealthState::kGood, HealthReason::kJudgedGood, "judged, no alarm stands", 0, 0};
  if (IsTrouble(e.trouble.reason)) Worsen(health, HealthState::kFailure, e.trouble.reason, e.trouble.text);
  if (!e.has_reference) {
    Worsen(health, HealthState::kFunctionCheck, HealthReason::kLearning, LearningText(e));
    health.learned = e.learned;
    health.needed = e.needed;
  }
  if (!e.not_judged.empty())
    Worsen(health, HealthState::kFunctionCheck, HealthReason::kStrokesNotJudged,
           "the last strokes were not judged: " + e.not_judged);
  TakeAlarms(e.alarms, health);
  return health;
}

Health JudgePressHealth(const std::vector<AlarmState>& alarms, const ServiceTrouble& trouble) {
  return JudgeHealth({.alarms = alarms, .has_reference = true, .trouble = trouble});
}

}  // namespace hydroscope
