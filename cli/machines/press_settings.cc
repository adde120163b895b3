#include "cli/machines/press_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/constants.h"
#include "core/finite_number.h"
#include "core/nearest_or_all.h"
#include "models/machine.h"
#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/imperfections.h"

namespace hydroscope {
namespace {

std::string ExtrasText(const std::vector<EffectExtra>& extras) {
  std::string text;
  for (const EffectExtra& extra : extras)
    text += fmt::format("; {}={:g} {}", extra.name, extra.value, extra.unit);
  return text;
}

std::vector<std::string> Parts(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// "NAME" or "NAME=SIZE", and further numbers and the channel, "on", behind commas.
struct SizedName {
  std::string name, channel;
  std::optional<double> size;
  std::map<std::string, double> extra;
};

Result<SizedName> ParseSizedName(const char* option, const std::string& text, const char* example,
                                 bool has_channel) {
  SizedName out;
  const auto parts = Parts(text, ',');
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto equals = parts[k].find('=');
    const std::string name = parts[k].substr(0, equals);
    const std::string given = equals == std::string::npos ? "" : parts[k].substr(equals + 1);
    if (k == 0) out.name = name;
    if (k == 0 && equals == std::string::npos) continue;
    if (k > 0 && has_channel && name == "on") {
      out.channel = given;
      continue;
    }
    const auto value = FiniteNumber(given);
    if (!value)
      return UsageError("--{} {}: '{}' is not NAME=NUMBER; expected e.g. {}", option, text, parts[k],
                        example);
    if (k == 0) {
      out.size = *value;
    } else {
      out.extra[name] = *value;
    }
  }
  return out;
}

struct FaultName {
  const char* name;
  FaultKind kind;
};
constexpr FaultName kFaultNames[] = {{"nan", FaultKind::kNan},
                                     {"stuck", FaultKind::kStuck},
                                     {"spike", FaultKind::kSpike},
                                     {"dropout", FaultKind::kDropout},
                                     {"offset_drift", FaultKind::kOffsetDrift},
                                     {"clock_jump", FaultKind::kClockJump}};

}  // namespace

Result<EffectSetting> ParseEffect(const std::string& text) {
  const auto given = TRY(ParseSizedName("effect", text, "relief_valve=2e-11,crack=170e5", false));
  EffectSetting effect{given.name, given.size.value_or(0), given.extra};
  for (const EffectInfo& info : PressEffects())
    if (!given.size && info.id == effect.id) effect.size = info.typical_size;
  return effect;
}

Result<ImperfectionSetting> ParseImperfection(const std::string& text) {
  const auto given = TRY(ParseSizedName("imperfection", text, "coloured_noise=0.1,phi=0.8,on=p_A", true));
  ImperfectionSetting setting{given.name, given.size.value_or(0), given.extra, given.channel};
  for (const ImperfectionInfo& info : PressImperfections())
    if (!given.size && info.name == setting.kind) setting.size = info.typical_size;
  if (!given.size && setting.size == 0) setting.size = std::nan("");  // unknown kind: the simulator says so
  return setting;
}

Result<SensorFault> ParseFault(const std::string& text) {
  constexpr const char* kForm = "expected kind:channel:start:duration[:size], e.g. stuck:p_A:30:2";
  const auto parts = Parts(text, ':');
  if (parts.size() < 4 || parts.size() > 5) return UsageError("--fault {}: {}", text, kForm);
  SensorFault fault;
  std::vector<std::string> names;
  bool found = false;
  for (const auto& [name, kind] : kFaultNames) {
    names.emplace_back(name);
    if (parts[0] != name) continue;
    fault.kind = kind;
    found = true;
  }
  if (!found)
    return UsageError("--fault {}: unknown kind '{}'; {}", text, parts[0], NearestOrAll(parts[0], names));
  fault.channel = parts[1];
  const bool whole_row = fault.kind == FaultKind::kDropout || fault.kind == FaultKind::kClockJump;
  if (whole_row && (fault.channel.empty() || fault.channel == "*" || fault.channel == "t"))
    fault.channel = "p_A";
  const auto start = FiniteNumber(parts[2]), duration = FiniteNumber(parts[3]);
  const auto size = parts.size() == 5 ? FiniteNumber(parts[4]) : 0.0;
  if (!start || !duration || !size) return UsageError("--fault {}: {}", text, kForm);
  const bool sized = fault.kind == FaultKind::kSpike || fault.kind == FaultKind::kOffsetDrift ||
                     fault.kind == FaultKind::kClockJump;
  if (sized && parts.size() < 5)
    return UsageError("--fault {}: a {} needs a size; {}", text, parts[0], kForm);
  fault.start = *start;
  fault.duration = *duration;
  fault.size = *size;
  return fault;
}

Status ParseOil(const std::string& text, PressOptions& options) {
  const auto parts = Parts(text, ':');
  const auto start = FiniteNumber(parts.front()), end = FiniteNumber(parts.back());
  if (parts.size() > 2 || !start || !end)
    return UsageError("--oil {}: expected START:END in degC, e.g. 26:52, or one temperature", text);
  options.oil_start = *start + kZeroCelsius;
  options.oil_end = *end + kZeroCelsius;
  return {};
}

Status TakeMachine(const std::string& path, PressOptions& options) {
  const auto machine = TRY(LoadMachine(path));
  PressMachine& m = options.machine;
  const std::map<std::string, double*> slots = {{"A_A", &m.A_A}, {"dp_nom", &m.dp_nom}, {"p_t", &m.p_tank}};
  for (const auto& [key, slot] : slots)
    if (const auto known = machine.Geometry(key)) *slot = known->value;
  return {};
}

SensorQuantum QuantumOfBits(int bits) {
  const double steps = std::exp2(bits);
  return {.p_A = 400e5 / steps,
          .p_B = 400e5 / steps,
          .p_0 = 400e5 / steps,
          .z = 0.25 / steps,
          .y_v = 2 / steps,
          .U_v = 20 / steps,
          .T_oil = 150 / steps};
}

nlohmann::json TruthJson(const PressTruth& truth) {
  const PressOptions& o = truth.options;
  const PressMachine& m = o.machine;
  nlohmann::json effects = nlohmann::json::array(), strokes = nlohmann::json::array(),
                 imperfections = nlohmann::json::array();
  for (const ImperfectionSetting& one : o.imperfections)
    imperfections.push_back(
        {{"kind", one.kind}, {"size", one.size}, {"extra", one.extra}, {"channel", one.channel}});
  for (const EffectSetting& effect : o.effects)
    effects.push_back({{"id", effect.id}, {"size", effect.size}, {"extra", effect.extra}});
  for (const StrokeTruth& s : truth.strokes)
    strokes.push_back({{"begin", s.begin},
                       {"end", s.end},
                       {"speed", s.speed},
                       {"z_begin", s.z_begin},
                       {"z_end", s.z_end},
                       {"oil_temperature", s.oil_temperature},
                       {"mean_pressure", s.mean_pressure},
                       {"max_pressure", s.max_pressure}});
  const nlohmann::json parameters = {{"K", m.K},
                                     {"V0", m.V0},
                                     {"Q_vn", m.Q_vn},
                                     {"y_0", m.y_0},
                                     {"A_A", m.A_A},
                                     {"dp_nom", m.dp_nom},
                                     {"p_supply", m.p_supply},
                                     {"p_tank", m.p_tank},
                                     {"p_rod", m.p_rod},
                                     {"valve_f0", m.valve_f0},
                                     {"valve_damping", m.valve_damping},
                                     {"valve_gain", m.valve_gain},
                                     {"valve_dead_time", m.valve_dead_time}};
  const nlohmann::json noise = {{"p_A", o.noise.p_A},    {"p_B", o.noise.p_B}, {"p_0", o.noise.p_0},
                                {"z", o.noise.z},        {"y_v", o.noise.y_v}, {"U_v", o.noise.U_v},
                                {"T_oil", o.noise.T_oil}};
  return {{"parameters", parameters},
          {"noise", noise},
          {"effects", effects},
          {"imperfections", imperfections},
          {"oil", {{"start", o.oil_start}, {"end", o.oil_end}}},
          {"seeds", {{"motion", o.seed}, {"control", o.control_seed}, {"noise", o.noise_seed}}},
          {"seconds", o.seconds},
          {"sample_period", o.sample_period},
          {"strokes", strokes}};
}

std::string ImperfectionTable() {
  std::string text =
      fmt::format("{:<34}{:<14}{:>10}  {}\n", "imperfection", "unit", "typical", "law (further numbers)");
  for (const ImperfectionInfo& info : PressImperfections())
    text += fmt::format("{:<34}{:<14}{:>10.3g}  {}{}{}\n", info.name, info.unit, info.typical_size, info.law,
                        ExtrasText(info.extras),
                        info.channel.empty() ? "" : fmt::format("; on={}", info.channel));
  return text;
}

std::string EffectTable() {
  std::string text =
      fmt::format("{:<28}{:<18}{:>10}  {}\n", "effect", "unit", "typical", "law (further numbers)");
  for (const EffectInfo& info : PressEffects())
    text += fmt::format("{:<28}{:<18}{:>10.3g}  {}{}\n", info.id, info.unit, info.typical_size, info.law,
                        ExtrasText(info.extras));
  return text;
}

}  // namespace hydroscope
