#include "cli/alarms_scada.h"

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/interval_text.h"
#include "core/records/alarm_records.h"
#include "core/records/estimate.h"
#include "core/short_number.h"
#include "core/time_text.h"
#include "host/output.h"
#include "live/scada_client.h"
#include "models/parameter_unit.h"
#include "setup/kind_columns.h"

namespace hydroscope {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kRowsShown = 10;
constexpr std::int64_t kNoStroke = 0xFFFFFFFF;  ///< of a row that belongs to none

Json AxisJson(const ScadaAxis& axis) {
  Json parameters = Json::object();
  for (const ScadaParameter& p : axis.parameters)
    parameters[p.name] = {{"value", p.value}, {"std", p.std}, {"quality", p.quality}};
  return {{"axis", axis.name},
          {"health", std::string(1, axis.health.letter())},
          {"health_reason", HealthReasonName(axis.health.reason)},
          {"strokes", axis.strokes},
          {"stroke_age_s", axis.stroke_age},
          {"oil_temperature_degC", axis.oil_temperature},
          {"parameters", parameters}};
}

Json ScadaAlarmJson(const ScadaAlarm& a) {
  return {{"number", a.number}, {"axis", a.axis},         {"alarm", a.name},
          {"state", a.state},   {"severity", a.severity}, {"raised_wall_s", a.raised},
          {"value", a.value},   {"std", a.std},           {"limit", a.limit}};
}

Json RowJson(const ScadaRow& r) {
  return {{"sequence", r.sequence}, {"wall_s", r.wall}, {"alarm", r.alarm},   {"axis", r.axis},
          {"event", r.event},       {"state", r.state}, {"stroke", r.stroke}, {"value", r.value}};
}

/// Why a parameter's value is not of the last stroke or episode (registers do not say which it is), or is not to be
/// trusted; "" if neither.
std::string QualityText(int quality) {
  static constexpr std::array kReasons = {"",
                                          "nothing yet",
                                          "the last was too short",
                                          "the last did not excite it",
                                          "the last could not separate it",
                                          "last estimate outside physics",
                                          "poor signals"};
  if (quality == 0) return "";
  if (quality == static_cast<int>(EstimateReason::kConfounded))  // of an older value, or of a new one
    return "  not to be told from others, or from what strokes do not show";
  const bool known = quality > 0 && quality < static_cast<int>(kReasons.size());
  return fmt::format("  older: {}", known ? kReasons[static_cast<std::size_t>(quality)] : "never identified");
}

/// The unit in which people read a number of this name, for the map carries names and SI values alone: what all kinds of
/// machines that have such a parameter agree upon; nullopt where they do not, and of numbers of the user's own.
std::optional<DisplayUnit> UnitByName(const std::string& parameter) {
  std::optional<DisplayUnit> unit;
  for (const MachineKind* kind : KindsToChoose())
    if (const MachineParameter* known = FindParameter(*kind, parameter)) {
      const DisplayUnit shown = ParameterUnit(*kind, parameter, known->si);
      if (unit && unit->name != shown.name) return std::nullopt;
      unit = shown;
    }
  return unit;
}

/// The same of an alarm's value, which is the size of the parameter or of the effect that the alarm is called by.
std::optional<std::pair<double, std::string>> FactorByEffect(const std::string& alarm) {
  std::optional<std::pair<double, std::string>> unit;
  for (const MachineKind* kind : KindsToChoose()) {
    if (kind->effects == nullptr) continue;
    for (const auto& effect : kind->effects(Machine{})) {
      if (effect->id != alarm) continue;
      const DisplayUnit shown = ParameterUnit(*kind, effect->parameter, effect->unit);
      if (unit && unit->second != shown.name) return std::nullopt;
      unit = {shown.factor, std::string(shown.name)};
    }
  }
  return unit;
}

std::string ParameterText(const ScadaParameter& p) {
  const DisplayUnit unit = UnitByName(p.name).value_or(DisplayUnit{1, 0, "SI"});
  return fmt::format("\n{:<16} {:<10} {:>22} {}{}", "", p.name,
                     WithInterval(p.value * unit.factor + unit.offset, kNormal95 * p.std * unit.factor),
                     unit.name, QualityText(p.quality));
}

std::string AxisText(const ScadaAxis& axis) {
  std::string text = fmt::format("{:<16} {} ({}: {}), {} stored", axis.name, axis.health.letter(),
                                 HealthName(axis.health.state), axis.health.text, axis.strokes);
  if (std::isfinite(axis.oil_temperature)) text += fmt::format(", oil {:.1f} °C", axis.oil_temperature);
  for (const ScadaParameter& p : axis.parameters) text += ParameterText(p);
  return text + "\n";
}

struct Seen {
  std::vector<ScadaAxis> axes;
  std::vector<ScadaAlarm> alarms;
  std::vector<ScadaRow> rows;
};

Result<Seen> Look(ScadaClient& client) {
  auto axes = TRY(client.Axes());
  auto alarms = TRY(client.Alarms());
  auto rows = TRY(client.NewRows());
  return Seen{std::move(axes), std::move(alarms), std::move(rows)};
}

std::string AxisName(const Seen& seen, int axis) {
  return axis < 1 || axis > static_cast<int>(seen.axes.size()) ? "-" : seen.axes[axis - 1].name;
}

void Print(const Seen& seen, const std::string& endpoint) {
  Say("axes, their parameters with 95 % intervals\n");
  for (const ScadaAxis& axis : seen.axes) Say(AxisText(axis));
  Say(seen.alarms.empty() ? "\nno alarm stands\n" : "\n");
  for (const ScadaAlarm& a : seen.alarms) {
    const std::string value = ScadaAlarmValue(a);
    Say(fmt::format("{:>3}  {:<5} {:<11} {} / {}, since {}{}{}\n", a.number, a.state, a.severity,
                    AxisName(seen, a.axis), a.name, LocalTimeText(static_cast<double>(a.raised)),
                    value.empty() ? "" : ", ", value));
  }
  if (!seen.alarms.empty())
    Say("acknowledge with `hydroscope alarms --modbus " + endpoint + " --ack NUMBER`\n");
  Say(fmt::format("\nnewest of {} journal rows in the ring\n", seen.rows.size()));
  const std::size_t first = seen.rows.size() - std::min(seen.rows.size(), kRowsShown);
  for (std::size_t i = first; i < seen.rows.size(); ++i) {
    const ScadaRow& r = seen.rows[i];
    Say(fmt::format("{:>6}  {}  no. {:<7} {} / alarm {}: {}{}\n", r.sequence, LocalTimeText(r.wall),
                    r.stroke == kNoStroke ? "-" : std::to_string(r.stroke), AxisName(seen, r.axis), r.alarm,
                    r.event, r.alarm == 0 ? "" : " -> " + r.state));
  }
}

}  // namespace

std::string ScadaAlarmValue(const ScadaAlarm& alarm) {
  if (alarm.severity == SeverityName(AlarmSeverity::kSignalLoss)) return "";
  const auto text = [&](double factor, double offset, std::string_view unit) {
    const double value = alarm.value * factor + offset;
    return fmt::format(
        "{} {}", alarm.std > 0 ? WithInterval(value, kNormal95 * alarm.std * factor) : ShortNumber(value),
        unit);
  };
  if (const auto unit = UnitByName(alarm.name)) return text(unit->factor, unit->offset, unit->name);
  if (const auto unit = FactorByEffect(alarm.name)) return text(unit->first, 0, unit->second);
  return text(1, 0, "SI");
}

Status ShowScada(const std::string& endpoint, int acknowledge, const std::string& json) {
  const std::size_t colon = endpoint.rfind(':');
  int port = 0;
  const char* const end = endpoint.data() + endpoint.size();
  if (colon == std::string::npos || colon == 0 ||
      std::from_chars(endpoint.data() + colon + 1, end, port).ptr != end || port < 1 || port > 65535)
    return UsageError("--modbus {}: expected HOST:PORT, e.g. 127.0.0.1:1503", endpoint);
  auto client = TRY(ScadaClient::Connect(endpoint.substr(0, colon), port));
  Json document;
  if (acknowledge > 0) {
    const auto changed = TRY(client.Acknowledge(acknowledge));
    document["acknowledged"] = {{"number", acknowledge}, {"changed", changed}};
    if (json != "-")
      Say(fmt::format("alarm {}{}\n", acknowledge, changed ? " acknowledged" : ": nothing to acknowledge"));
  }
  const auto seen = TRY(Look(client));
  if (json != "-") Print(seen, endpoint);
  if (json.empty()) return {};
  for (const char* list : {"axes", "alarms", "journal"}) document[list] = Json::array();
  for (const ScadaAxis& axis : seen.axes) document["axes"].push_back(AxisJson(axis));
  for (const ScadaAlarm& alarm : seen.alarms) document["alarms"].push_back(ScadaAlarmJson(alarm));
  for (const ScadaRow& row : seen.rows) document["journal"].push_back(RowJson(row));
  return WriteJson(json, document);
}

}  // namespace hydroscope
