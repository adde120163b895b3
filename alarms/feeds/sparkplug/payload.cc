#include "alarms/feeds/sparkplug/payload.h"

#include <fmt/format.h>

#include <cmath>

#include "alarms/feeds/sparkplug/sparkplug_b.pb.h"
#include "core/constants.h"

namespace hydroscope::sparkplug {
namespace {

namespace tahu = org::eclipse::tahu::protobuf;
using tahu::Payload;

constexpr const char* kRebirth = "Node Control/Rebirth";
/// Good and bad as OPC and most SCADA systems code them.
constexpr std::uint32_t kGood = 192, kBad = 0;

std::uint64_t Milliseconds(double wall) { return wall > 0 ? static_cast<std::uint64_t>(wall * 1e3) : 0; }

/// Adds metrics of one time to a payload.
class Metrics {
 public:
  explicit Metrics(double wall) { payload_.set_timestamp(Milliseconds(wall)); }

  /// Below 0: not known, null.
  Payload::Metric& Whole(const std::string& name, std::int64_t value) {
    Payload::Metric& metric = Add(name, tahu::Int64);
    if (value >= 0)
      metric.set_long_value(static_cast<std::uint64_t>(value));
    else
      metric.set_is_null(true);
    return metric;
  }
  Payload::Metric& Flag(const std::string& name, bool value) {
    Payload::Metric& metric = Add(name, tahu::Boolean);
    metric.set_boolean_value(value);
    return metric;
  }
  Payload::Metric& Text(const std::string& name, const std::string& value) {
    Payload::Metric& metric = Add(name, tahu::String);
    metric.set_string_value(value);
    return metric;
  }
  /// A number with its unit; what is not known is null.
  Payload::Metric& Number(const std::string& name, double value, const std::string& unit = "") {
    Payload::Metric& metric = Add(name, tahu::Double);
    if (std::isfinite(value))
      metric.set_double_value(value);
    else
      metric.set_is_null(true);
    if (!unit.empty()) {
      Payload::PropertyValue& property = Property(metric, "engUnit", tahu::String);
      property.set_string_value(unit);
    }
    return metric;
  }
  static Payload::PropertyValue& Property(Payload::Metric& metric, const std::string& key,
                                          tahu::DataType type) {
    metric.mutable_properties()->add_keys(key);
    Payload::PropertyValue& value = *metric.mutable_properties()->add_values();
    value.set_type(type);
    return value;
  }
  std::string Bytes() const { return payload_.SerializeAsString(); }
  Payload& payload() { return payload_; }

 private:
  Payload::Metric& Add(const std::string& name, tahu::DataType type) {
    Payload::Metric& metric = *payload_.add_metrics();
    metric.set_name(name);
    metric.set_timestamp(payload_.timestamp());
    metric.set_datatype(type);
    return metric;
  }

  Payload payload_;
};

void AddAxis(Metrics& metrics, const AxisPicture& axis) {
  metrics.Text("Health", std::string(1, axis.health.letter()));
  metrics.Text("Health/Reason", HealthReasonName(axis.health.reason));
  metrics.Text("Health/Text", axis.health.text);
  metrics.Whole("Strokes", axis.strokes);
  metrics.Number("Oil temperature",
                 axis.estimates.empty() ? std::nan("") : axis.estimates[0].oil_temperature - kZeroCelsius,
                 "degC");
  for (const TrendPoint& point : axis.estimates) {
    const Estimate& e = point.estimate;
    Payload::Metric& value = metrics.Number("Parameters/" + e.parameter, e.value, e.unit);
    Metrics::Property(value, "Quality", tahu::Int32)
        .set_int_value(e.reason == EstimateReason::kUpdated ? kGood : kBad);
    metrics.Number("Parameters/" + e.parameter + "/Std", e.std, e.unit);
    metrics.Text("Parameters/" + e.parameter + "/Reason", ReasonName(e.reason));
  }
}

/// The metrics of an event.
void AddEvent(Metrics& metrics, const JournalRow& row) {
  const AlarmEvent& e = row.event;
  metrics.Whole("Event/Sequence", row.sequence);
  metrics.Text("Event/Alarm", e.alarm);
  metrics.Text("Event/Event", e.event);
  metrics.Text("Event/State before", e.state_before);
  metrics.Text("Event/State", e.state);
  metrics.Text("Event/Severity", SeverityName(e.severity));
  metrics.Whole("Event/Stroke", e.stroke);
  metrics.Whole("Event/First stroke", e.first_stroke);
  metrics.Whole("Event/Last stroke", e.last_stroke);
  metrics.Number("Event/Value", e.value, e.unit);
  metrics.Number("Event/Std", e.std, e.unit);
  metrics.Number("Event/Limit", e.limit, e.unit);
  metrics.Number("Event/Oil temperature", e.oil_temperature - kZeroCelsius, "degC");
  metrics.Whole("Event/Model version", e.model_version);
  metrics.Whole("Event/Reference version", e.reference_version);
  metrics.Text("Event/User", e.user);
  metrics.Text("Event/Comment", e.comment);
  metrics.Text("Event/Text", e.text);
  metrics.Text("Event/Cause", e.cause);
}

}  // namespace

std::string NodeBirth(std::uint8_t birth_death, double wall) {
  Metrics metrics(wall);
  metrics.Whole("bdSeq", birth_death);
  metrics.Flag(kRebirth, false);
  metrics.Text("Properties/Software", "Hydroscope");
  return metrics.Bytes();
}

std::string NodeDeath(std::uint8_t birth_death) {
  Metrics metrics(0);
  metrics.Whole("bdSeq", birth_death);
  metrics.payload().clear_timestamp();
  metrics.payload().mutable_metrics(0)->clear_timestamp();
  return metrics.Bytes();
}

std::string DeviceBirth(const AxisPicture& axis, double wall) {
  Metrics metrics(wall);
  AddAxis(metrics, axis);
  for (const AlarmState& alarm : axis.alarms) metrics.Text("Alarms/" + alarm.id, StateName(alarm));
  for (const AlarmState& alarm : axis.alarms) metrics.Text("Causes/" + alarm.id, CauseText(alarm.cause));
  // No event happens now: its metrics are announced without values.
  const int announced = metrics.payload().metrics_size();
  AddEvent(metrics, {});
  for (int k = announced; k < metrics.payload().metrics_size(); ++k) {
    Payload::Metric& metric = *metrics.payload().mutable_metrics(k);
    metric.clear_value();
    metric.set_is_null(true);
  }
  return metrics.Bytes();
}

std::string DeviceData(const AxisPicture& axis, double wall) {
  Metrics metrics(wall);
  AddAxis(metrics, axis);
  return metrics.Bytes();
}

std::string Event(const JournalRow& row) {
  Metrics metrics(row.wall);
  AddEvent(metrics, row);
  if (!row.event.alarm.empty()) {
    metrics.Text("Alarms/" + row.event.alarm, row.event.state);
    metrics.Text("Causes/" + row.event.alarm, row.event.cause);
  }
  return metrics.Bytes();
}

std::optional<std::string> Sealed(const std::string& bytes, std::uint8_t sequence, bool historical) {
  Payload payload;
  if (!payload.ParseFromString(bytes)) return std::nullopt;
  payload.set_seq(sequence);
  if (historical)
    for (Payload::Metric& metric : *payload.mutable_metrics()) metric.set_is_historical(true);
  return payload.SerializeAsString();
}

bool AsksForRebirth(const std::string& bytes) {
  Payload payload;
  if (!payload.ParseFromString(bytes)) return false;
  for (const Payload::Metric& metric : payload.metrics())
    if (metric.name() == kRebirth && metric.boolean_value()) return true;
  return false;
}

std::optional<ToldRow> RowOf(const std::string& bytes) {
  Payload payload;
  if (!payload.ParseFromString(bytes)) return std::nullopt;
  ToldRow row;
  for (const Payload::Metric& metric : payload.metrics()) {
    if (metric.name() == "Event/Sequence") row.sequence = static_cast<std::int64_t>(metric.long_value());
    if (metric.name() == "Event/Alarm") row.alarm = metric.string_value();
    if (metric.name() == "Event/Comment") row.comment = metric.string_value();
  }
  if (row.sequence == 0) return std::nullopt;
  return row;
}

std::string HealthOf(const std::string& bytes) {
  Payload payload;
  if (!payload.ParseFromString(bytes)) return "";
  for (const Payload::Metric& metric : payload.metrics())
    if (metric.name() == "Health") return metric.string_value();
  return "";
}

std::vector<Tag> TagsOf(const std::string& bytes) {
  std::vector<Tag> tags;
  Payload payload;
  if (!payload.ParseFromString(bytes)) return tags;
  for (const Payload::Metric& metric : payload.metrics()) {
    Tag tag;
    tag.name = metric.name();
    for (int k = 0; k < metric.properties().keys_size() && k < metric.properties().values_size(); ++k)
      if (metric.properties().keys(k) == "engUnit") tag.unit = metric.properties().values(k).string_value();
    switch (metric.datatype()) {
      case tahu::Int64:
        tag.type = "Int64";
        tag.value = std::to_string(static_cast<std::int64_t>(metric.long_value()));
        break;
      case tahu::Boolean:
        tag.type = "Boolean";
        tag.value = metric.boolean_value() ? "true" : "false";
        break;
      case tahu::Double:
        tag.type = "Double";
        tag.value = fmt::format("{:.6g}", metric.double_value());
        break;
      default:
        tag.type = "String";
        tag.value = metric.string_value();
    }
    if (metric.is_null()) tag.value.clear();
    tags.push_back(std::move(tag));
  }
  return tags;
}

std::string TopicPart(const std::string& name) {
  std::string part = name;
  for (char& c : part)
    if (c == '/' || c == '+' || c == '#') c = '_';
  return part;
}

}  // namespace hydroscope::sparkplug
