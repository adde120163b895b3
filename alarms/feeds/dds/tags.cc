#include "alarms/feeds/dds/tags.h"

#include <fmt/format.h>

#include <cmath>

#include "alarms/feeds/dds/messages.h"

namespace hydroscope {
namespace {

const char* IdlType(std::uint16_t) { return "unsigned short"; }
const char* IdlType(std::int32_t) { return "long"; }
const char* IdlType(std::int64_t) { return "long long"; }
const char* IdlType(double) { return "double"; }
const char* IdlType(char) { return "char"; }
const char* IdlType(bool) { return "boolean"; }
const char* IdlType(const std::string&) { return "string"; }
template <std::size_t kLength>
std::string IdlType(const eprosima::fastrtps::fixed_string<kLength>&) {
  return fmt::format("string<{}>", kLength);
}

std::string TextOf(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }
template <std::size_t kLength>
std::string TextOf(const eprosima::fastrtps::fixed_string<kLength>& value) {
  return value.c_str();
}
template <typename Value>
std::string TextOf(const Value& value) {
  return fmt::format("{}", value);
}

/// Lists the members of one message after the other.
class MemberTags {
 public:
  /// What is listed from here on; `of`: in front of the names of the members. Not `known`: there is no such message yet.
  void Begin(std::string topic, std::string axis, std::string of, bool known) {
    topic_ = std::move(topic);
    axis_ = std::move(axis);
    of_ = std::move(of);
    known_ = known;
  }
  template <typename Value>
  void Add(const char* member, const Value& value, std::string unit = "", std::string meaning = "") {
    tags_.push_back({std::string(DdsFeedSpec::kName), axis_, topic_, of_ + ", " + member, IdlType(value),
                     std::move(unit), std::move(meaning), known_ ? TextOf(value) : ""});
  }
  std::vector<Tag> Take() { return std::move(tags_); }

 private:
  std::string topic_, axis_, of_;
  bool known_ = true;
  std::vector<Tag> tags_;
};

void AddEvent(const hydroscope_wire::AlarmEvent& m, MemberTags& tags) {
  tags.Add("machine", m.machine());
  tags.Add("alarm", m.alarm(), "", "empty: the axis as a whole");
  tags.Add("version", m.version());
  tags.Add("journal_sequence", m.journal_sequence(), "", "without gaps");
  tags.Add("wall_time_ns", m.wall_time_ns(), "ns", "since 1970");
  tags.Add("machine_time", m.machine_time(), "s");
  tags.Add("stroke", m.stroke(), "", "-1: not known");
  tags.Add("event", m.event(), "", "raised, cleared, acknowledged, ...");
  tags.Add("state_before", m.state_before(), "", "ISA-18.2");
  tags.Add("state", m.state(), "", "ISA-18.2");
  tags.Add("severity", m.severity());
  const std::string unit = m.unit().c_str();
  tags.Add("value", m.value(), unit);
  tags.Add("std", m.std(), unit);
  tags.Add("limit", m.limit(), unit);
  tags.Add("unit", m.unit(), "", "of value, std and limit, SI");
  tags.Add("oil_temperature", m.oil_temperature(), "K");
  tags.Add("model_version", m.model_version());
  tags.Add("reference_version", m.reference_version());
  tags.Add("user", m.user());
  tags.Add("comment", m.comment());
  tags.Add("text", m.text());
  tags.Add("first_stroke", m.first_stroke(), "", "evidence");
  tags.Add("last_stroke", m.last_stroke(), "", "evidence");
}

void AddFinding(const hydroscope_wire::Finding& m, MemberTags& tags) {
  tags.Add("machine", m.machine(), "", "key");
  tags.Add("alarm", m.alarm(), "", "key; empty: the axis as a whole");
  tags.Add("version", m.version());
  tags.Add("state", m.state(), "", "ISA-18.2");
  tags.Add("severity", m.severity());
  tags.Add("health", m.health(), "", "of the axis, NE 107: F, C, S, M, - good");
  tags.Add("active", m.active());
  tags.Add("acknowledged", m.acknowledged());
  tags.Add("raised_wall_time_ns", m.raised_wall_time_ns(), "ns", "since 1970");
  tags.Add("raised_stroke", m.raised_stroke(), "", "-1: not known");
  const std::string unit = m.unit().c_str();
  tags.Add("value", m.value(), unit);
  tags.Add("std", m.std(), unit);
  tags.Add("limit", m.limit(), unit);
  tags.Add("unit", m.unit(), "", "of value, std and limit, SI");
  tags.Add("text", m.text());
  tags.Add("first_stroke", m.first_stroke(), "", "evidence");
  tags.Add("last_stroke", m.last_stroke(), "", "evidence");
}

}  // namespace

std::vector<Tag> DdsTags(const DdsFeedSpec& spec, const std::vector<AxisPicture>& axes,
                         const std::optional<JournalRow>& newest) {
  MemberTags tags;
  tags.Begin(spec.topic + "/alarms", "", "newest event", newest.has_value());
  AddEvent(ToWire(newest.value_or(JournalRow())), tags);
  for (const AxisPicture& axis : axes) {
    tags.Begin(spec.topic + "/findings", axis.machine, "health", true);
    AddFinding(ToWire(axis, HealthAsAlarm(axis.health)), tags);
    for (const AlarmState& alarm : axis.alarms) {
      tags.Begin(spec.topic + "/findings", axis.machine, alarm.id, true);
      AddFinding(ToWire(axis, alarm), tags);
    }
  }
  return tags.Take();
}

}  // namespace hydroscope
