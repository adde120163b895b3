#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/counted_words.h"
#include "core/records/alarm_records.h"

namespace hydroscope {

/// Health of an axis after NAMUR NE 107, in order of urgency; the number is the code of the register map.
enum class HealthState { kGood, kMaintenance, kOutOfSpecification, kFunctionCheck, kFailure };
/// '-', 'M', 'S', 'C', 'F'.
char HealthLetter(HealthState state);
/// The other way; any other letter is a function check.
HealthState HealthStateOf(char letter);
/// "good", "maintenance required", "out of specification", "function check", "failure".
const char* HealthName(HealthState state);

/// What health comes from; the number is the code of the register map.
enum class HealthReason {
  kJudgedGood,        ///< strokes are judged, and no alarm stands
  kAlarms,            ///< alarms of the axis
  kLearning,          ///< the healthy machine is being learned: nothing is judged yet
  kStrokesNotJudged,  ///< the last strokes could not be judged (cold oil, a kind of stroke never seen)
  kOutOfService,      ///< somebody took an alarm out of service
  kNothingKnown,      ///< nobody has judged the axis since the start
  kDiskFull,          ///< strokes are not stored: the disk is full
  kDatabaseLocked,    ///< ... another program holds the database
  kDatabaseGone,      ///< ... the database file was deleted, moved or replaced
  kNotStored,         ///< ... for another reason
  kNotWatched,        ///< strokes are not judged: journal, rules or database cannot be used
};
/// "judged_good", "alarms", "learning", ...: what JSON calls it.
const char* HealthReasonName(HealthReason reason);
/// The other way; any other name is kNothingKnown.
HealthReason HealthReasonNamed(std::string_view name);
/// Whether it keeps the service from storing or judging at all.
bool IsTrouble(HealthReason reason);

/// The one answer that status, registers, Sparkplug, DDS and metrics all give.
struct Health {
  HealthState state = HealthState::kFunctionCheck;
  HealthReason reason = HealthReason::kNothingKnown;
  std::string text = "nothing has been judged yet";  ///< "learning the healthy machine, 19 of 100 strokes"
  std::int64_t learned = 0, needed = 0;  ///< strokes of commissioning; 0 once there is a reference
  std::string german = "noch wurde nichts beurteilt";  ///< `text` in German; "": it is told in English alone

  char letter() const { return HealthLetter(state); }
  bool operator==(const Health&) const = default;
};

/// What keeps the service from storing or judging; kJudgedGood: nothing does.
struct ServiceTrouble {
  HealthReason reason = HealthReason::kJudgedGood;
  Told text;
  bool operator==(const ServiceTrouble&) const = default;
};

/// What is known of an axis.
struct HealthEvidence {
  const std::vector<AlarmState>& alarms;
  bool has_reference = false;            ///< there is something to judge by
  std::int64_t learned = 0, needed = 0;  ///< strokes of commissioning, told if there is no reference
  Told not_learned = {};                 ///< why they will not be learned; "" if they will
  Told not_judged = {};                  ///< why the last strokes were not judged; "" if they were
  ServiceTrouble trouble = {};
  CountedWords counted = {};  ///< what the machine is judged by
};

/// The most urgent of trouble (F), alarms (signal loss F, alarm S, warning and advisory M; shelved ones
/// count, suppressed ones and those out of service do not), learning, strokes that cannot be judged and
/// alarms out of service (C). Good only where strokes are judged against a reference and nothing stands.
Health JudgeHealth(const HealthEvidence& evidence);

/// Health of a press as a whole, which has alarms but no strokes of its own.
Health JudgePressHealth(const std::vector<AlarmState>& alarms, const ServiceTrouble& trouble = {});

}  // namespace hydroscope
