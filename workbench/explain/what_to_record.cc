#include "workbench/explain/what_to_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Spread of the ram speed over its mean below which strokes count as of one speed: leakage and valve flow then part by
/// less than their noise (log f of the example presses).
constexpr double kOneSpeed = 0.15;

/// What tells two effects apart. Laws that differ only in one quantity need strokes that vary that quantity alone.
struct Separation {
  std::string_view a, b, move;
};
constexpr std::string_view kPressureSteps =
    "strokes at one slow ram speed and clearly different cushion pressures (for example 60, 120 and 200 bar)";
constexpr std::string_view kRodSide =
    "strokes at the same cushion pressure but different pressure in chamber B, or a hold with the ram at "
    "rest while chamber B is relieved";
constexpr std::string_view kOpenings =
    "strokes with the same flow at different spool openings: a fast ram at high "
    "pressure and the same ram speed at low pressure";
constexpr std::string_view kSteps =
    "quick steps: of the valve command while the ram moves steadily, and of the "
    "ram speed while the valve stands still";
constexpr std::string_view kLowPressure =
    "strokes that start from a few bar and rise to working pressure, so that "
    "the stiffness is seen at low pressure too";
constexpr std::string_view kRelieved =
    "the pressure sensor with chamber A relieved to tank (it must read zero), "
    "then strokes at clearly different pressures";
constexpr std::array<Separation, 17> kSeparations = {{
    {"internal_leakage", "external_leakage", kRodSide},
    {"internal_leakage", "orifice_leakage", kPressureSteps},
    {"external_leakage", "orifice_leakage", kPressureSteps},
    {"internal_leakage", "relief_valve", kPressureSteps},
    {"external_leakage", "relief_valve", kPressureSteps},
    {"orifice_leakage", "relief_valve", kPressureSteps},
    {"internal_leakage", "pressure_offset", kRelieved},
    {"external_leakage", "pressure_offset", kRelieved},
    {"orifice_leakage", "pressure_offset", kRelieved},
    {"entrained_air", "accumulator", kLowPressure},
    {"tank_back_pressure", "valve_flow_curvature", kOpenings},
    {"tank_back_pressure", "spool_overlap", kOpenings},
    {"spool_signal_delay", "pressure_signal_delay", kSteps},
    {"spool_signal_delay", "position_signal_delay", kSteps},
    {"pressure_signal_delay", "position_signal_delay", kSteps},
    {"spool_signal_delay", "spool_hysteresis", kSteps},
    {"line_inertance", "spool_signal_delay", kSteps},
}};

/// What makes one effect stand out on its own.
struct Driver {
  std::string_view id, move;
};
constexpr std::array<Driver, 18> kDrivers = {{
    {"internal_leakage", "a pressure hold with the ram at rest, and strokes at different ram speeds"},
    {"external_leakage", "a pressure hold with the ram at rest, and strokes at different ram speeds"},
    {"orifice_leakage", kPressureSteps},
    {"entrained_air", kLowPressure},
    {"accumulator", kLowPressure},
    {"relief_valve", kPressureSteps},
    {"tank_back_pressure", kOpenings},
    {"valve_flow_curvature", kOpenings},
    {"valve_flow_asymmetry", "strokes in which the valve also opens towards the supply"},
    {"spool_overlap", "slow strokes with the spool near its null as well as fast ones"},
    {"spool_hysteresis", "strokes in which the spool turns back and forth while the ram moves"},
    {"oil_viscosity", "strokes with cold and with warm oil, 15 K or more apart"},
    {"pressure_offset", kRelieved},
    {"spool_signal_delay", kSteps},
    {"pressure_signal_delay", kSteps},
    {"position_signal_delay", kSteps},
    {"position_dependent_leakage", "slow strokes over the whole cylinder length at one high pressure"},
    {"line_inertance", kSteps},
}};

/// Effect::told_apart_by, where the library says so.
std::string_view ToldApartBy(const ExplainResult& result, const std::string& id) {
  const Effect* effect = result.FindEffect(id);
  return effect == nullptr ? std::string_view{} : std::string_view(effect->told_apart_by);
}

std::string_view MoveFor(const ExplainResult& result, const std::string& a, const std::string& b) {
  for (const Separation& s : kSeparations)
    if ((s.a == a && s.b == b) || (s.a == b && s.b == a)) return s.move;
  for (const std::string& id : {b, a})
    if (const std::string_view move = ToldApartBy(result, id); !move.empty()) return move;
  for (const std::string& id : {b, a})
    for (const Driver& driver : kDrivers)
      if (driver.id == id) return driver.move;
  return "strokes at different ram speeds and pressures";
}

/// Spread of a quantity over the strokes, relative to its mean.
template <typename Get>
double RelativeSpread(const std::vector<StrokeRecord>& strokes, Get get) {
  double low = INFINITY, high = -INFINITY, sum = 0;
  for (const StrokeRecord& s : strokes) {
    const double x = get(s.summary);
    low = std::min(low, x);
    high = std::max(high, x);
    sum += std::abs(x);
  }
  return sum > 0 ? (high - low) / (sum / static_cast<double>(strokes.size())) : 0.0;
}

/// What to say where all strokes are alike in a condition that hides something then.
std::optional<std::string> Monotony(const ExplainResult& result) {
  const std::vector<Condition>& conditions = result.log.model->conditions;
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const auto value = [c](const StrokeSummary& s) { return s.conditions[c]; };
    if (conditions[c].hides.empty() || RelativeSpread(result.log.strokes, value) >= kOneSpeed) continue;
    const DisplayUnit unit = DisplayUnitFor(conditions[c].unit);
    const double shown = value(result.log.strokes.front().summary) * unit.factor;
    return fmt::format(
        "All strokes ran at nearly the same {0} ({1:.0f} {2}): {3}. Record strokes at two or three clearly "
        "different values of it, such as {4:.0f}, {1:.0f} and {5:.0f} {2}, and explain again.",
        conditions[c].vary, shown, unit.name, conditions[c].hides, 0.5 * shown, 1.5 * shown);
  }
  return std::nullopt;
}

std::string Separating(const ExplainResult& result) {
  std::string text;
  for (const auto& group : result.explanation.groups) {
    if (group.size() < 2) continue;
    std::vector<std::string_view> moves;
    for (std::size_t k = 1; k < group.size(); ++k) {
      const std::string_view move = MoveFor(result, group.front(), group[k]);
      if (std::find(moves.begin(), moves.end(), move) != moves.end()) continue;
      moves.push_back(move);
      text += fmt::format("{}To tell {} from {}, record {}.", text.empty() ? "" : " ", group.front(),
                          group[k], move);
    }
  }
  return text;
}

/// Tests off the log that decide between rivals, also those that no series of strokes tells apart.
std::string OffTheLog(const ExplainResult& result) {
  std::vector<std::string> tests, told;
  for (const auto& group : result.explanation.groups) {
    if (group.size() < 2) continue;
    for (const std::string& id : group) {
      const Effect* effect = result.FindEffect(id);
      if (effect == nullptr || effect->measured_by.empty()) continue;
      tests.push_back(fmt::format("{} ({})", effect->measured_by, id));
      told.push_back(fmt::format("--measured {}=SIZE:STANDARD_ERROR", id));
    }
  }
  if (tests.empty()) return "";
  const std::vector<std::string>& left = result.experiment.left;
  return fmt::format(" {}ake {}, and explain with {}.",
                     left.empty()
                         ? "Instead of strokes, t"
                         : fmt::format("No stroke tells {} from all others: t", fmt::join(left, ", ")),
                     fmt::join(tests, "; "), fmt::join(told, " "));
}

/// What would excite the effects these strokes cannot test.
std::string Exciting(const std::vector<RankedEffect>& ranking) {
  std::string text;
  std::vector<std::string_view> moves;
  for (const RankedEffect& ranked : ranking) {
    if (ranked.testable) continue;
    for (const Driver& driver : kDrivers) {
      if (driver.id != ranked.id || std::find(moves.begin(), moves.end(), driver.move) != moves.end())
        continue;
      moves.push_back(driver.move);
      text += fmt::format("{}To test {}, record {}.", text.empty() ? "" : " ", ranked.id, driver.move);
    }
  }
  return text;
}

}  // namespace

std::optional<std::string> WhatToRecord(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  if (result.log.model->kind->own_library) {
    if (x.verdict != Verdict::kAmbiguous) return std::nullopt;
    if (!result.signal_experiment.inputs.empty()) return SignalExperimentText(result.signal_experiment);
    return "Record strokes in which the expressions of these effects go different ways; explain the logs "
           "themselves to have such strokes computed.";
  }
  const std::optional<std::string> monotony = Monotony(result);
  if (x.verdict == Verdict::kAmbiguous) {
    const std::string off_the_log = OffTheLog(result);
    if (!result.experiment.pressures.empty()) return ExperimentText(result.experiment) + off_the_log;
    const std::string separating =
        "No series of strokes within [experiment] of the machine file would settle it." +
        (off_the_log.empty() ? " " + Separating(result) : off_the_log);
    return monotony ? *monotony + " " + separating : separating;
  }
  if (monotony) return monotony;
  if (x.verdict == Verdict::kNamed) return std::nullopt;
  const std::string exciting = Exciting(x.ranking);
  return exciting.empty() ? std::nullopt : std::optional(exciting);
}

}  // namespace hydroscope
