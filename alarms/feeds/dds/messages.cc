#include "alarms/feeds/dds/messages.h"

namespace hydroscope {
namespace {

std::int64_t Nanoseconds(double wall) { return static_cast<std::int64_t>(wall * 1e9); }

/// Bounded texts of the wire.
template <std::size_t kLength>
void Put(eprosima::fastrtps::fixed_string<kLength>& to, const std::string& text) {
  to = text.substr(0, kLength);
}

}  // namespace

hydroscope_wire::AlarmEvent ToWire(const JournalRow& row) {
  const AlarmEvent& e = row.event;
  hydroscope_wire::AlarmEvent wire;
  Put(wire.machine(), row.machine);
  Put(wire.alarm(), e.alarm);
  wire.version(hydroscope_wire::kAlarmVersion);
  wire.journal_sequence(row.sequence);
  wire.wall_time_ns(Nanoseconds(row.wall));
  wire.machine_time(e.time);
  wire.stroke(e.stroke);
  Put(wire.event(), e.event);
  Put(wire.state_before(), e.state_before);
  Put(wire.state(), e.state);
  Put(wire.severity(), SeverityName(e.severity));
  wire.value(e.value);
  wire.std(e.std);
  wire.limit(e.limit);
  Put(wire.unit(), e.unit);
  wire.oil_temperature(e.oil_temperature);
  wire.model_version(e.model_version);
  wire.reference_version(e.reference_version);
  wire.user(e.user);
  wire.comment(e.comment);
  wire.text(e.text);
  wire.first_stroke(e.first_stroke);
  wire.last_stroke(e.last_stroke);
  return wire;
}

hydroscope_wire::Finding ToWire(const AxisPicture& axis, const AlarmState& a) {
  hydroscope_wire::Finding wire;
  Put(wire.machine(), axis.machine);
  Put(wire.alarm(), a.id);
  wire.version(hydroscope_wire::kAlarmVersion);
  Put(wire.state(), StateName(a));
  Put(wire.severity(), SeverityName(a.severity));
  wire.health(axis.health.letter());
  wire.active(a.active);
  wire.acknowledged(a.acknowledged);
  wire.raised_wall_time_ns(Nanoseconds(a.raised_wall));
  wire.raised_stroke(a.raised_stroke);
  wire.value(a.value);
  wire.std(a.std);
  wire.limit(a.limit);
  Put(wire.unit(), a.unit);
  wire.text(a.text);
  wire.first_stroke(a.first_stroke);
  wire.last_stroke(a.last_stroke);
  return wire;
}

AlarmState HealthAsAlarm(const Health& health) {
  AlarmState state;
  state.text = health.text;
  return state;
}

}  // namespace hydroscope
