#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/told.h"

namespace hydroscope {

/// Urgency, lowest first. Loss of signal stands apart: nothing is known, neither good nor bad.
enum class AlarmSeverity { kAdvisory, kWarning, kAlarm, kSignalLoss };
const char* SeverityName(AlarmSeverity severity);
Told SeverityTold(AlarmSeverity severity);
std::optional<AlarmSeverity> SeverityFromName(const std::string& name);

/// How far comparing the strokes before and after a change carries its cause; the number is the code of the
/// register map.
enum class CauseKind {
  kNotSought,  ///< nothing was compared (yet), or the alarm is not about the machine
  kNamed,      ///< these effects of the library appeared
  kSeveral,    ///< one of them did, and the strokes cannot tell which
  kNotKnown,   ///< no effect of the library explains the change
  kNotProven,  ///< these come nearest, and the comparison does not prove that it is one of them
};
struct AlarmCause {
  CauseKind kind = CauseKind::kNotSought;
  std::vector<std::string> effects;  ///< ids, best first; kNamed, kSeveral, kNotProven
  bool operator==(const AlarmCause&) const = default;
};
/// "", "not known", "internal_leakage", "one of internal_leakage, external_leakage",
/// "not proven; nearest: internal_leakage, supply_leakage".
Told CauseTold(const AlarmCause& cause);
std::string CauseText(const AlarmCause& cause);
/// "not_sought", "named", "one_of_several", "not_known", "not_proven".
const char* CauseKindName(CauseKind kind);

/// What an alarm says, by what it tells. Of one that no finding raises all of it is `finding`.
struct AlarmWords {
  Told finding;   ///< "Oil column softer"
  Told evidence;  ///< "since stroke 48210: K -10.0 ± 0.6 % (12000 -> 10800 bar)", what comparing strokes said
  Told action;    ///< what to do
  bool operator==(const AlarmWords&) const = default;
};

/// Why an alarm is suppressed by design; several may hold at once.
enum Suppression : std::uint8_t {
  kSuppressedIdle = 1,         ///< the machine rests
  kSuppressedValveCheck = 2,   ///< valve check running
  kSuppressedTooCold = 4,      ///< oil below the minimum temperature
  kSuppressedCommonCause = 8,  ///< the machine's own alarm says it for all axes
};

/// One alarm of one axis: orthogonal flags from which the state's name is derived (ISA-18.2-2016, fig. 3; IEC 62682).
struct AlarmState {
  std::string id;  ///< "internal_leakage", "K.alarm_low", "signal_loss", ...
  AlarmSeverity severity = AlarmSeverity::kWarning;
  bool active = false;       ///< the condition holds, delays passed
  bool acknowledged = true;  ///< a person has seen the present annunciation
  bool latched = false;      ///< stays annunciated until reset though the condition has gone
  bool out_of_service = false;
  std::uint8_t suppressed = 0;                              ///< Suppression flags
  std::optional<double> shelved_until;                      ///< s since 1970
  int on_count = 0, off_count = 0;                          ///< strokes towards the on- and off-delay
  double value = std::numeric_limits<double>::quiet_NaN();  ///< SI, latest
  double std = std::numeric_limits<double>::quiet_NaN();    ///< SI
  double limit = std::numeric_limits<double>::quiet_NaN();  ///< SI
  std::string unit;                                         ///< SI
  std::string text;                                         ///< finding and guidance
  AlarmWords words;                     ///< the same apart; empty in alarms of old journals
  AlarmCause cause;                     ///< of what was found
  std::vector<std::string> quantities;  ///< parameters and effects it speaks of, the most evident first
  double raised_time = 0;               ///< s, machine time
  double raised_wall = 0;               ///< s since 1970
  std::int64_t raised_stroke = 0;
  std::int64_t first_stroke = -1, last_stroke = -1;  ///< evidence

  bool operator==(const AlarmState&) const = default;
};

/// "NORM", "UNACK", "ACKED", "RTNUN", "LTUNK", "LTACK", "SHLVD", "DSUPR", "OOSRV".
const char* StateName(const AlarmState& alarm);

/// One thing that happened to an alarm, or to the axis as a whole (empty `alarm`); a row of the journal.
struct AlarmEvent {
  std::string alarm;
  std::string event;  ///< "raised", "cleared", "acknowledged", "shelved", "reference_learned", ...
  std::string state_before, state;
  AlarmSeverity severity = AlarmSeverity::kAdvisory;
  double time = std::numeric_limits<double>::quiet_NaN();  ///< s, machine (log) time
  std::int64_t stroke = -1;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< SI
  double std = std::numeric_limits<double>::quiet_NaN();
  double limit = std::numeric_limits<double>::quiet_NaN();
  std::string unit;
  double oil_temperature = std::numeric_limits<double>::quiet_NaN();  ///< K
  int model_version = 0, reference_version = 0;
  std::string user, comment, text;
  std::string cause;                                 ///< CauseText
  std::int64_t first_stroke = -1, last_stroke = -1;  ///< evidence
};

/// A row of the journal.
struct JournalRow {
  std::int64_t sequence = 0;
  std::string machine;
  double wall = 0;  ///< s since 1970
  AlarmEvent event;
};

}  // namespace hydroscope
