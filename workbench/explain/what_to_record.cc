#include "workbench/explain/what_to_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Spread of the ram speed over its mean below which strokes count as of one speed: leakage and valve flow then part by
/// less than their noise (log f of the example presses).
constexpr double kOneSpeed = 0.15;

/// Strokes that one of the two says of the other; "" if it says nothing.
std::string SeparationBy(const Effect& effect, const std::string& other) {
  for (const Effect::Separation& separation : effect.separations)
    if (separation.id == other) return separation.strokes;
  return "";
}

/// What tells two effects apart: what one says of the other, else what shows one of them at all.
std::string MoveFor(const ExplainResult& result, const std::string& id_a, const std::string& id_b) {
  const Effect *found_a = result.FindEffect(id_a), *found_b = result.FindEffect(id_b);
  const Effect a = found_a == nullptr ? Effect{} : *found_a, b = found_b == nullptr ? Effect{} : *found_b;
  for (const std::string& strokes : {SeparationBy(a, id_b), SeparationBy(b, id_a), b.told_apart_by,
                                     a.told_apart_by, b.shown_by, a.shown_by})
    if (!strokes.empty()) return strokes;
  return fmt::format("strokes that differ in {}", result.log.model->words.vary);
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
    std::vector<std::string> moves;
    for (std::size_t k = 1; k < group.size(); ++k) {
      const std::string move = MoveFor(result, group.front(), group[k]);
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
std::string Exciting(const ExplainResult& result) {
  std::string text;
  std::set<std::string> told;
  for (const RankedEffect& ranked : result.explanation.ranking) {
    const Effect* effect = ranked.testable ? nullptr : result.FindEffect(ranked.id);
    if (effect == nullptr || effect->shown_by.empty() || !told.insert(effect->shown_by).second) continue;
    text += fmt::format("{}To test {}, record {}.", text.empty() ? "" : " ", ranked.id, effect->shown_by);
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
    if (result.experiment.proposed()) return ExperimentText(result.experiment) + off_the_log;
    const std::string separating =
        (result.log.model->kind->experiment.on == nullptr
             ? fmt::format("Nothing can be computed to record on a {}.", result.log.model->kind->title)
             : "No series of strokes within [experiment] of the machine file would settle it.") +
        (off_the_log.empty() ? " " + Separating(result) : off_the_log);
    return monotony ? *monotony + " " + separating : separating;
  }
  if (monotony) return monotony;
  if (x.verdict == Verdict::kNamed) return std::nullopt;
  const std::string exciting = Exciting(result);
  return exciting.empty() ? std::nullopt : std::optional(exciting);
}

}  // namespace hydroscope
