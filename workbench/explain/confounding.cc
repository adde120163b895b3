#include "workbench/explain/confounding.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/contains.h"
#include "core/effect_units.h"
#include "core/unit_told.h"
#include "core/units.h"
#include "diagnosis/hidden_bias.h"
#include "models/parameter_unit.h"

namespace hydroscope {
namespace {

constexpr std::size_t kMostStrokesConfounded = 400;
constexpr std::size_t kFewestStrokes = 3;  ///< below them intervals say nothing, and so does this

std::vector<StrokeGram> EvenlySpread(std::span<const StrokeGram> grams) {
  const std::size_t step = (grams.size() + kMostStrokesConfounded - 1) / kMostStrokesConfounded;
  std::vector<StrokeGram> out;
  for (std::size_t k = 0; k < grams.size(); k += std::max<std::size_t>(1, step)) out.push_back(grams[k]);
  return out;
}

Told ReasonFor(const MachineKind& kind, const Confounding& c, const Effect& effect,
               const Estimate& parameter) {
  const EffectUnit size = EffectUnitFor(effect.unit);
  const DisplayUnit unit = ParameterUnit(kind, parameter.parameter, parameter.unit);
  return Tell(
      "confounded with {}: {} of a usual size ({:.2g} {}) would move it by {:+.2g} {} without being seen",
      "nicht zu trennen von {}: {} üblicher Größe ({:.2g} {}) verschöbe ihn unbemerkt um {:+.2g} {}",
      fmt::to_string(fmt::join(c.effects, ", ")), effect.id, effect.typical * size.factor,
      UnitTold(size.name), c.bias * unit.factor, unit.name == "-" ? Told{} : UnitTold(unit.name));
}

}  // namespace

std::vector<Confounding> ConfoundingsOf(const std::vector<std::string>& added,
                                        std::shared_ptr<const ModelStructure> model,
                                        std::span<const StrokeGram> grams, const WindowSamples& window,
                                        std::span<const ConditionRange> ranges,
                                        std::span<const Estimate> parameters) {
  std::vector<Confounding> out;
  if (grams.size() < kFewestStrokes || model->effects.empty()) return out;
  const StrokeSet strokes(model, EvenlySpread(grams), window);
  std::vector<EffectChoice> choices;
  for (int e = 0; e < static_cast<int>(model->effects.size()); ++e) {
    if (!Contains(added, model->effects[e]->id)) continue;
    const EffectChoice best = strokes.BestShape(e, choices);
    if (best.shape >= 0) choices.push_back(best);
  }
  const ExtendedFit fit = strokes.Fit(choices);
  if (!fit.solved) return out;
  for (const HiddenBias& bias : ConfoundedBiases(strokes, fit, parameters)) {
    const Estimate& parameter = parameters[bias.parameter];
    const std::string& id = model->effects[bias.effect]->id;
    if (out.empty() || out.back().parameter != parameter.parameter)
      out.push_back({parameter.parameter, id, {}, bias.bias, {}, {}});
    out.back().effects.push_back(id);
  }
  for (Confounding& c : out) {
    const auto is = [&](const Estimate& e) { return e.parameter == c.parameter; };
    const Estimate& parameter = *std::ranges::find_if(parameters, is);
    for (const auto& effect : model->effects)
      if (effect->id == c.effect) c.reason = ReasonFor(*model->kind, c, *effect, parameter);
    c.advice = Tell("record strokes that differ more in {}, with holds between them",
                    "Hübe aufzeichnen, die sich darin mehr unterscheiden: {}, mit Halten dazwischen",
                    model->words.vary);
    for (const ConditionRange& range : ranges)
      if (!range.condition.hides.empty() && !range.varies())
        c.advice = Tell("vary {} between strokes", "zwischen den Hüben variieren: {}", range.condition.vary);
  }
  return out;
}

void MarkConfounded(const std::vector<Confounding>& confounded, std::span<Estimate> parameters) {
  for (Estimate& e : parameters)
    if (e.reason == EstimateReason::kUpdated && FindConfounding(confounded, e.parameter) != nullptr)
      e.reason = EstimateReason::kConfounded;
}

std::string ConfoundedNames(const std::vector<Confounding>& confounded) {
  if (confounded.empty()) return "";
  std::vector<std::string> names, effects;
  for (const Confounding& c : confounded) {
    names.push_back(c.parameter);
    for (const std::string& id : c.effects)
      if (!Contains(effects, id)) effects.push_back(id);
  }
  return fmt::format("{}: confounded with {}", fmt::join(names, ", "), fmt::join(effects, ", "));
}

const Confounding* FindConfounding(const std::vector<Confounding>& confounded, const std::string& parameter) {
  for (const Confounding& c : confounded)
    if (c.parameter == parameter) return &c;
  return nullptr;
}

}  // namespace hydroscope
