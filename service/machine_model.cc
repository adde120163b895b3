#include "service/machine_model.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/units.h"
#include "diagnosis/nonlinear_scatter.h"
#include "models/effect.h"

namespace hydroscope {
namespace {

/// Over the effects of the model, whose nonlinear parameters depend on one another.
constexpr int kPasses = 2;

}  // namespace

Result<int> FindEffect(const ModelStructure& model, const std::string& id) {
  for (std::size_t e = 0; e < model.effects.size(); ++e)
    if (model.effects[e]->id == id) return static_cast<int>(e);
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
    const StrokeSet strokes(log.model, GramsOf(log.model, log.stretches, log.window), log.window);
    for (const std::string& id : log.machine.added_effects) {
      const auto effect = FindEffect(*log.model, id);
      if (!effect) return tl::unexpected(effect.error());
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
