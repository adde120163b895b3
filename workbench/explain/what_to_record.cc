#include "workbench/explain/what_to_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/contains.h"
#include "core/units.h"

namespace hydroscope {
namespace {

/// Spread of a condition over its mean below which strokes count as alike in it: what Condition::hides then parts by less
/// than its noise (a leak and the valve's flow at one speed, `hydroscope simulate press` at constant speed).
constexpr double kLeastSpread = 0.15;

/// Strokes that one of the two says of the other; "" if it says nothing.
Told SeparationBy(const Effect& effect, const std::string& other) {
  for (const Effect::Separation& separation : effect.separations)
    if (separation.id == other) return separation.strokes;
  return {};
}

/// Also of those that are tried on samples alone; one without words if the library has none of this name.
Effect KnownEffect(const ExplainResult& result, const std::string& id) {
  if (const Effect* effect = result.FindEffect(id)) return *effect;
  for (const auto& effect : result.log.model->sample_effects)
    if (effect->id == id) return *effect;
  return {};
}

}  // namespace

Told WhatTellsApart(const ExplainResult& result, const std::string& id_a, const std::string& id_b) {
  const Effect a = KnownEffect(result, id_a), b = KnownEffect(result, id_b);
  for (const Told& strokes :
       {SeparationBy(a, id_b), SeparationBy(b, id_a), Told(b.told_apart_by, b.german.told_apart_by),
        Told(a.told_apart_by, a.german.told_apart_by), b.shown_by, a.shown_by})
    if (!strokes.empty()) return strokes;
  return Tell("strokes that differ in {}", "Hübe, die sich darin unterscheiden: {}",
              result.log.model->words.vary);
}

namespace {

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
std::optional<Told> Monotony(const ExplainResult& result) {
  const std::vector<Condition>& conditions = result.log.model->conditions;
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const auto value = [c](const StrokeSummary& s) { return s.conditions[c]; };
    if (conditions[c].hides.empty() || RelativeSpread(result.log.strokes, value) >= kLeastSpread) continue;
    const DisplayUnit unit = DisplayUnitFor(conditions[c].unit);
    const double shown = value(result.log.strokes.front().summary) * unit.factor;
    return Tell(
        "All strokes ran at nearly the same {0} ({1:.0f} {2}): {3}. Record strokes at two or three clearly "
        "different values of it, such as {4:.0f}, {1:.0f} and {5:.0f} {2}, and explain again.",
        "Fast gleich in allen Hüben: {0} ({1:.0f} {2}); {3}. Hübe bei zwei oder drei deutlich verschiedenen Werten "
        "aufzeichnen, etwa {4:.0f}, {1:.0f} und {5:.0f} {2}, und wieder erklären lassen.",
        conditions[c].vary, shown, unit.name, conditions[c].hides, 0.5 * shown, 1.5 * shown);
  }
  return std::nullopt;
}

Told Separating(const ExplainResult& result) {
  std::vector<Told> text;
  for (const auto& group : result.explanation.groups) {
    if (group.size() < 2) continue;
    std::vector<Told> moves;
    for (std::size_t k = 1; k < group.size(); ++k) {
      const Told move = WhatTellsApart(result, group.front(), group[k]);
      if (Contains(moves, move)) continue;
      moves.push_back(move);
      text.push_back(Tell("To tell {} from {}, record {}.", "Um {} von {} zu trennen, aufzeichnen: {}.",
                          group.front(), group[k], move));
    }
  }
  return Joined(text, " ");
}

/// Of the rivals those that a test off the log gives the size of.
std::vector<const Effect*> Measurable(const ExplainResult& result) {
  std::vector<const Effect*> measurable;
  for (const auto& group : result.explanation.groups) {
    if (group.size() < 2) continue;
    for (const std::string& id : group)
      if (const Effect* effect = result.FindEffect(id); effect != nullptr && !effect->measured_by.empty())
        measurable.push_back(effect);
  }
  return measurable;
}

/// Tests off the log that decide between rivals, also those that no series of strokes tells apart.
Told OffTheLog(const ExplainResult& result) {
  std::vector<Told> tests;
  for (const Effect* effect : Measurable(result))
    tests.push_back(Tell("{} ({})", "{} ({})", effect->measured_by, effect->id));
  if (tests.empty()) return {};
  const std::string left = fmt::to_string(fmt::join(result.experiment.left, ", "));
  const Told begin = left.empty() ? Tell("Instead of strokes, take", "Statt Hüben nehmen:")
                                  : Tell("No stroke tells {} from all others: take",
                                         "Kein Hub trennt {} von allen anderen; zu nehmen:", left);
  return Tell("{} {}, and have it explained again with what the test gave.",
              "{} {}, und mit dem, was die Prüfung ergab, wieder erklären lassen.", begin,
              Joined(tests, "; "));
}

/// What would excite the effects these strokes cannot test.
Told Exciting(const ExplainResult& result) {
  std::vector<Told> text;
  std::set<std::string> told;
  for (const RankedEffect& ranked : result.explanation.ranking) {
    const Effect* effect = ranked.testable ? nullptr : result.FindEffect(ranked.id);
    if (effect == nullptr || effect->shown_by.empty() || !told.insert(effect->shown_by.english).second)
      continue;
    text.push_back(
        Tell("To test {}, record {}.", "Um {} zu prüfen, aufzeichnen: {}.", ranked.id, effect->shown_by));
  }
  return Joined(text, " ");
}

/// Those that are there, one behind the other.
Told Sentences(std::vector<Told> sentences) {
  std::erase_if(sentences, [](const Told& sentence) { return sentence.empty(); });
  return Joined(sentences, " ");
}

/// The signals without which a cause much like those named could not be tried.
Told ToMeasure(const Explanation& x) {
  if (x.unmeasured.empty()) return {};
  return Tell(
      "Measure {} as well, with a line in [signals] of the machine file: without it the cause is not proven.",
      "Auch {} messen, mit einer Zeile in [signals] der Maschinendatei: ohne das ist die Ursache nicht belegt.",
      fmt::to_string(fmt::join(x.unmeasured, ", ")));
}

}  // namespace

std::optional<Told> WhatToRecord(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  if (result.log.model->kind->own_library) {
    if (x.verdict != Verdict::kAmbiguous) return std::nullopt;
    if (!result.signal_experiment.inputs.empty()) return SignalExperimentText(result.signal_experiment);
    return Tell(
        "Record strokes in which the expressions of these effects go different ways; explain the logs "
        "themselves to have such strokes computed.",
        "Hübe aufzeichnen, in denen die Ausdrücke dieser Effekte verschieden verlaufen; an den Aufzeichnungen selbst "
        "lassen sich solche Hübe berechnen.");
  }
  const std::optional<Told> monotony = Monotony(result);
  if (x.verdict == Verdict::kAmbiguous) {
    const Told off_the_log = OffTheLog(result);
    if (result.experiment.proposed())
      return Sentences({ExperimentText(result.experiment), off_the_log, ToMeasure(x)});
    const Told separating = Sentences(
        {result.log.model->kind->experiment.on == nullptr
             ? Tell("Nothing can be computed to record on a {}.",
                    "Was aufzuzeichnen wäre, lässt sich hier nicht berechnen ({}).",
                    result.log.model->kind->title)
             : Tell("No series of strokes within [experiment] of the machine file would settle it.",
                    "Keine Reihe von Hüben innerhalb von [experiment] der Maschinendatei würde es klären."),
         off_the_log.empty() ? Separating(result) : off_the_log, ToMeasure(x)});
    return monotony ? Sentences({*monotony, separating}) : separating;
  }
  if (monotony) return monotony;
  if (x.verdict == Verdict::kNamed) {
    const Told measure = ToMeasure(x);
    return measure.empty() ? std::nullopt : std::optional(measure);
  }
  const Told exciting = Exciting(result);
  return exciting.empty() ? std::nullopt : std::optional(exciting);
}

std::string MeasuredArguments(const ExplainResult& result) {
  if (result.explanation.verdict != Verdict::kAmbiguous || result.log.model->kind->own_library) return "";
  std::vector<std::string> arguments;
  for (const Effect* effect : Measurable(result))
    arguments.push_back(fmt::format("--measured {}=SIZE:STANDARD_ERROR", effect->id));
  return fmt::to_string(fmt::join(arguments, " "));
}

}  // namespace hydroscope
