#include "core/records/alarm_records.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

namespace hydroscope {
namespace {

constexpr std::array<const char*, 4> kSeverities = {"advisory", "warning", "alarm", "signal_loss"};

}  // namespace

const char* SeverityName(AlarmSeverity severity) { return kSeverities[static_cast<std::size_t>(severity)]; }

Told SeverityTold(AlarmSeverity severity) {
  static const std::array<const char*, 4> kGerman = {"Hinweis", "Warnung", "Alarm", "Signalverlust"};
  return {SeverityName(severity), kGerman[static_cast<std::size_t>(severity)]};
}

std::optional<AlarmSeverity> SeverityFromName(const std::string& name) {
  for (std::size_t i = 0; i < kSeverities.size(); ++i)
    if (name == kSeverities[i]) return static_cast<AlarmSeverity>(i);
  return std::nullopt;
}

Told CauseTold(const AlarmCause& cause) {
  const auto listed = fmt::format("{}", fmt::join(cause.effects, ", "));
  switch (cause.kind) {
    case CauseKind::kNotSought:
      return {};
    case CauseKind::kNamed:
      return Tell("{}", "{}", listed);
    case CauseKind::kSeveral:
      return Tell("one of {}", "eine von {}", listed);
    case CauseKind::kNotProven:
      return Tell("not proven; nearest: {}", "nicht bewiesen; am nächsten kommt: {}", listed);
    case CauseKind::kNotKnown:
      break;
  }
  return Tell("not known", "nicht bekannt");
}

std::string CauseText(const AlarmCause& cause) { return CauseTold(cause).english; }

const char* CauseKindName(CauseKind kind) {
  static constexpr std::array<const char*, 5> kNames = {"not_sought", "named", "one_of_several", "not_known",
                                                        "not_proven"};
  return kNames[static_cast<std::size_t>(kind)];
}

const char* StateName(const AlarmState& alarm) {
  if (alarm.out_of_service) return "OOSRV";
  if (alarm.shelved_until) return "SHLVD";
  if (alarm.suppressed != 0) return "DSUPR";
  if (alarm.active) return alarm.acknowledged ? "ACKED" : "UNACK";
  if (alarm.latched) return alarm.acknowledged ? "LTACK" : "LTUNK";
  return alarm.acknowledged ? "NORM" : "RTNUN";
}

}  // namespace hydroscope
