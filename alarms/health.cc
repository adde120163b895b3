#include "alarms/health.h"

#include <algorithm>

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
void Worsen(Health& health, HealthState state, HealthReason reason, Told told) {
  if (state <= health.state) return;
  health.state = state;
  health.reason = reason;
  health.text = std::move(told.english);
  health.german = std::move(told.german);
}

/// What was found; alarms of old journals have their id alone.
Told CalledAs(const AlarmState& alarm) {
  return alarm.words.finding.empty() ? Told{alarm.id} : alarm.words.finding;
}

void TakeAlarms(const std::vector<AlarmState>& alarms, Health& health) {
  for (const AlarmState& alarm : alarms) {
    if (alarm.out_of_service)
      Worsen(health, HealthState::kFunctionCheck, HealthReason::kOutOfService,
             Tell("out of service: {}", "außer Betrieb: {}", CalledAs(alarm)));
    else if (alarm.active && alarm.suppressed == 0)
      Worsen(health, StateOf(alarm.severity), HealthReason::kAlarms,
             Tell("{} ({})", "{} ({})", CalledAs(alarm), SeverityTold(alarm.severity)));
  }
}

Told LearningText(const HealthEvidence& e) {
  if (!e.not_learned.empty())
    return Tell("nothing is judged: {}", "nichts wird beurteilt: {}", e.not_learned);
  if (e.learned >= e.needed)
    return Tell("nothing is judged: {} {} wait for `hydroscope learn`",
                "nichts wird beurteilt: {} {} warten auf `hydroscope learn`", e.learned, e.counted.Several());
  return Tell("learning the healthy machine, {} of {} {}", "die gesunde Maschine wird gelernt, {} von {} {}",
              e.learned, e.needed, e.counted.SeveralDative());
}

}  // namespace

char HealthLetter(HealthState state) { return kStates[static_cast<std::size_t>(state)].letter; }
const char* HealthName(HealthState state) { return kStates[static_cast<std::size_t>(state)].name; }
const char* HealthReasonName(HealthReason reason) { return kReasons[static_cast<std::size_t>(reason)]; }
HealthState HealthStateOf(char letter) {
  const auto found = std::ranges::find(kStates, letter, &StateWords::letter);
  return found == kStates.end() ? HealthState::kFunctionCheck
                                : static_cast<HealthState>(found - kStates.begin());
}
HealthReason HealthReasonNamed(std::string_view name) {
  const auto found =
      std::ranges::find(kReasons, name, [](const char* known) { return std::string_view(known); });
  return found == kReasons.end() ? HealthReason::kNothingKnown
                                 : static_cast<HealthReason>(found - kReasons.begin());
}
bool IsTrouble(HealthReason reason) { return reason >= HealthReason::kDiskFull; }

Health JudgeHealth(const HealthEvidence& e) {
  Health health{HealthState::kGood,
                HealthReason::kJudgedGood,
                "judged, no alarm stands",
                0,
                0,
                "beurteilt, kein Alarm steht an"};
  if (IsTrouble(e.trouble.reason)) Worsen(health, HealthState::kFailure, e.trouble.reason, e.trouble.text);
  if (!e.has_reference) {
    Worsen(health, HealthState::kFunctionCheck, HealthReason::kLearning, LearningText(e));
    health.learned = e.learned;
    health.needed = e.needed;
  }
  if (!e.not_judged.empty())
    Worsen(health, HealthState::kFunctionCheck, HealthReason::kStrokesNotJudged,
           Tell("the last {} were not judged: {}", "die letzten {} wurden nicht beurteilt: {}",
                e.counted.Several(), e.not_judged));
  TakeAlarms(e.alarms, health);
  return health;
}

Health JudgePressHealth(const std::vector<AlarmState>& alarms, const ServiceTrouble& trouble) {
  return JudgeHealth({.alarms = alarms, .has_reference = true, .trouble = trouble});
}

}  // namespace hydroscope
