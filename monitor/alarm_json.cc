#include "monitor/alarm_json.h"

#include <nlohmann/json.hpp>

#include "core/json_value.h"

namespace hydroscope {

nlohmann::json AlarmJson(const std::string& machine, const AlarmState& a) {
  return {{"machine", machine},
          {"alarm", a.id},
          {"state", StateName(a)},
          {"severity", SeverityName(a.severity)},
          {"active", a.active},
          {"acknowledged", a.acknowledged},
          {"latched", a.latched},
          {"shelved_until_s", JsonOrNull(a.shelved_until)},
          {"suppressed", a.suppressed},
          {"out_of_service", a.out_of_service},
          {"value", a.value},
          {"std", a.std},
          {"limit", a.limit},
          {"unit", a.unit},
          {"text", a.text},
          {"cause", CauseText(a.cause)},
          {"cause_kind", CauseKindName(a.cause.kind)},
          {"cause_effects", a.cause.effects},
          {"raised_stroke", a.raised_stroke},
          {"raised_wall_s", a.raised_wall},
          {"first_stroke", a.first_stroke},
          {"last_stroke", a.last_stroke}};
}

nlohmann::json JournalRowJson(const JournalRow& row) {
  const AlarmEvent& e = row.event;
  return {{"sequence", row.sequence},
          {"machine", row.machine},
          {"wall_s", row.wall},
          {"time_s", e.time},
          {"stroke", e.stroke},
          {"alarm", e.alarm},
          {"event", e.event},
          {"state_before", e.state_before},
          {"state", e.state},
          {"severity", SeverityName(e.severity)},
          {"value", e.value},
          {"std", e.std},
          {"limit", e.limit},
          {"unit", e.unit},
          {"oil_temperature_K", e.oil_temperature},
          {"model_version", e.model_version},
          {"reference_version", e.reference_version},
          {"user", e.user},
          {"comment", e.comment},
          {"text", e.text},
          {"cause", e.cause},
          {"first_stroke", e.first_stroke},
          {"last_stroke", e.last_stroke}};
}

}  // namespace hydroscope
