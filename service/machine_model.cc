#include "service/machine_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/units.h"
#include "diagnosis/nonlinear_scatter.h"
#include "diagnosis/residuals.h"
#include "diagnosis/tone_search.h"
#include "models/effect.h"

namespace hydroscope {
namespace {

/// Over the effects of the model, whose nonlinear parameters depend on one another.
constexpr int kPasses = 2;

bool FitsSignals(const Effect& effect, const ModelStructure& model) {
  return std::all_of(effect.channels.begin(), effect.channels.end(),
                     [&](int channel) { return model.channel_source[channel] >= 0; });
}

StrokeSet StrokesUnder(const ModelStructure& structure, const LogStrokes& log) {
  const auto model = std::make_shared<const ModelStructure>(structure);
  return {model, GramsOf(model, log.stretches, log.window), log.window};
}

/// Searches what the model with `choices` leaves for the shape of an effect that no grid holds; true if it is
/// there.
bool SearchShape(const LogStrokes& log, const StrokeSet& strokes, const std::vector<EffectChoice>& choices,
                 ModelStructure& structure) {
  const ExtendedFit fit = strokes.Fit(choices);
  return fit.solved && AddSearchedShapes(structure, log.stretches, ColumnWeights(strokes.model(), fit));
}

}  // namespace

Result<int> FindEffect(const ModelStructure& model, const std::string& id) {
  for (std::size_t e = 0; e < model.effects.size(); ++e)
    if (model.effects[e]->id == id) return static_cast<int>(e);
  for (const auto& effect : model.sample_effects)
    if (effect->id == id && FitsSignals(*effect, model))
      return BadInput(
          "effect '{}' cannot be judged on stored strokes, which keep no columns of it: give a log", id);
  std::vector<std::string> ids;
  for (const auto& effect : model.effects) ids.push_back(effect->id);
  for (const auto& effect : DieCushionEffects({})) {
    if (model.name != "die_cushion") break;
    ids.push_back(effect->id);
    if (effect->id != id) continue;
    std::vector<std::string> missing;
    for (int channel : effect->channels)
      if (model.channel_source[channel] < 0) missing.push_back(model.channel_names[channel]);
    return BadInput("effect '{}' needs signal {}, which the machine file does not have", id,
                    fmt::join(missing, ", "));
  }
  const std::string near = Nearest(id, ids);
  return BadInput("unknown effect '{}'; {}", id,
                  near.empty()
                      ? fmt::format("known effects: {}", fmt::join(ids, ", "))
                      : fmt::format("did you mean '{}'? 'hydroscope model effects' lists them all", near));
}

Result<MachineModel> FitMachineModel(const LogStrokes& log) {
  auto structure = std::make_shared<ModelStructure>(*log.model);
  std::vector<EffectChoice> choices;
  if (!log.machine.added_effects.empty()) {
    AddSampleEffects(*structure, log.machine.added_effects);
    StrokeSet strokes = StrokesUnder(*structure, log);
    for (const std::string& id : log.machine.added_effects) {
      const auto effect = FindEffect(*structure, id);
      if (!effect) return tl::unexpected(effect.error());
      if (structure->effect_shapes[*effect].empty() && SearchShape(log, strokes, choices, *structure))
        strokes = StrokesUnder(*structure, log);
      const EffectChoice best = strokes.BestShape(*effect, choices);
      if (best.shape < 0)
        return BadInput(
            "these strokes cannot tell effect '{}' of the machine file from the rest of the model: record "
            "strokes at different ram speeds and pressures, or take it out with 'hydroscope model remove {}'",
            id, id);
      choices.push_back(best);
    }
    for (int pass = 0; pass < kPasses; ++pass)
      choices = RefineModel(*structure, log.stretches, log.window, choices);
  }
  MachineModel out{structure, choices, {}};
  out.fit = StrokeSet(structure, GramsOf(structure, log.stretches, log.window), log.window).Fit(choices);
  if (!out.fit.solved)
    return BadInput(
        "the strokes do not excite all parameters of the model: vary ram speed and pressure, or record "
        "longer");
  out.trust = JudgeLog(log, out.fit.theta, out.fit.noise_floor);
  WidenByNonlinear(structure, log.stretches, log.window, choices, out.fit);
  return out;
}

}  // namespace hydroscope
