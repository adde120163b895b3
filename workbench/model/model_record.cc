#include "workbench/model/model_record.h"

#include "core/told_error.h"
#include "diagnosis/interpolated_shapes.h"
#include "diagnosis/shape_freedom.h"
#include "models/counted_words.h"
#include "models/find_effect.h"
#include "workbench/explain/explain_log.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {
namespace {

ModelEvidence Evidence(const Machine& machine, const MachineModel& model, const std::string& source,
                       std::int64_t strokes) {
  ModelEvidence out;
  ModelRecord& record = out.record;
  record.version = machine.model_version;
  record.name = ModelName(machine);
  record.effects = machine.added_effects;
  record.source = source;
  record.strokes = static_cast<int>(strokes);
  record.rms_holdout = model.figures.rms_holdout;
  record.noise_floor = model.figures.noise_floor;
  record.unit = model.structure->output_unit;
  for (const Estimate& e : model.figures.parameters) {
    record.parameters.push_back({e.parameter, e.value, e.std, e.unit});
    if (e.reason == EstimateReason::kOutsidePhysics) out.outside_physics.push_back(e.parameter);
  }
  out.excess = model.fit.excess;
  for (const EffectChoice& choice : model.choices) {
    const Effect& effect = *model.structure->effects[choice.effect];
    const std::vector<double>& nonlinear =
        model.structure->effect_shapes[choice.effect][choice.shape].nonlinear;
    for (std::size_t i = 0; i < nonlinear.size(); ++i)
      out.effect_values[effect.id][effect.nonlinear[i].name] = nonlinear[i];
  }
  return out;
}

}  // namespace

std::string ModelName(const Machine& machine) {
  std::string name = "base";
  for (const std::string& id : machine.added_effects) name += " + " + id;
  return name;
}

Result<ModelEvidence> JudgeModel(const Machine& machine, LogStrokes strokes, const std::string& source) {
  strokes.machine = machine;
  if (strokes.stretches.size() < kMinExplainStrokes)
    return BadInput(Tell("{}: {} inside the gate, expected at least {} to judge a model on",
                         "{}: {} im Gate, erwartet: mindestens {}, um ein Modell daran zu beurteilen", source,
                         CountedWordsOf(machine).CountedTold(strokes.stretches.size()), kMinExplainStrokes));
  auto model = TRY(FitMachineModel(strokes));
  model.figures.noise_floor = TrustedFloor(strokes, model);
  return Evidence(machine, model, source, static_cast<std::int64_t>(strokes.stretches.size()));
}

Result<MachineModel> FitHistoryModel(const Machine& machine, const StrokeHistory& history) {
  if (history.units.size() < 2)
    return BadInput(Tell("{}: {} in the chosen part of the history, expected at least 2",
                         "{}: {} im gewählten Teil der Geschichte, erwartet mindestens 2", history.database,
                         CountedWordsOf(machine).CountedTold(history.units.size())));
  auto structure = std::make_shared<ModelStructure>(*history.model);
  std::vector<int> effects;
  for (const std::string& id : machine.added_effects) {
    const auto effect = TRY(FindEffect(*structure, id));
    effects.push_back(effect);
    AddInterpolatedShapes(*structure, effect);
  }
  const StrokeSet strokes(structure, history.units, history.window, history.noise_scale);
  std::vector<EffectChoice> choices;
  for (const int effect : effects) {
    choices.push_back(strokes.BestShape(effect, choices));
    if (choices.back().shape < 0)
      return BadInput(
          Tell("{}: the stored strokes cannot tell effect '{}' from the rest of the model",
               "{}: die gespeicherten Hübe können den Effekt '{}' nicht vom Rest des Modells unterscheiden",
               history.database, structure->effects[effect]->id));
  }
  MachineModel out{structure, choices, strokes.Fit(choices), {}, {}};
  if (!out.fit.solved)
    return BadInput(Tell("{}: the strokes do not excite all parameters of the model",
                         "{}: die Hübe regen nicht alle Parameter des Modells an", history.database));
  WidenByStoredShapes(strokes, choices, out.fit);
  strokes.Widen(choices, out.fit);
  out.figures = FiguresOf(*structure, out.fit, strokes.strokes());
  MarkCarriedByError(strokes, out.fit, out.figures);
  out.figures.noise_floor = history.NoiseFloor(structure, choices, out.fit);
  return out;
}

Result<ModelEvidence> JudgeModel(const Machine& machine, const StrokeHistory& history) {
  if (history.units.size() < kMinExplainStrokes)
    return BadInput(Tell("{}: {}, expected at least {} to judge a model on",
                         "{}: {}, erwartet mindestens {}, um ein Modell zu beurteilen", history.database,
                         CountedWordsOf(machine).CountedTold(history.units.size()), kMinExplainStrokes));
  const auto model = TRY(FitHistoryModel(machine, history));
  return Evidence(machine, model, history.database, history.strokes());
}

}  // namespace hydroscope
