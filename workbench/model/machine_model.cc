#include "workbench/model/machine_model.h"

#include <cmath>

#include "core/non_negative.h"
#include "core/told_error.h"
#include "diagnosis/hidden_bias.h"
#include "diagnosis/nonlinear_scatter.h"
#include "diagnosis/refine.h"
#include "diagnosis/remainder/residuals.h"
#include "diagnosis/remainder/tone_search.h"
#include "diagnosis/sample_grams.h"
#include "estimation/error_trust.h"
#include "models/effect.h"
#include "models/find_effect.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Over the effects of the model, whose nonlinear parameters depend on one another.
constexpr int kPasses = 2;

StrokeSet StrokesOfLogUnder(const ModelStructure& structure, const LogStrokes& log) {
  const auto model = std::make_shared<const ModelStructure>(structure);
  return {model, GramsOf(model, log.stretches, log.window), log.window};
}

/// Searches what the model with `choices` leaves for the shape of an effect that no grid holds; true if it is there.
bool SearchShape(const LogStrokes& log, const StrokeSet& strokes, const std::vector<EffectChoice>& choices,
                 ModelStructure& structure) {
  const ExtendedFit fit = strokes.Fit(choices);
  return fit.solved && AddSearchedShapes(structure, log.stretches, ColumnWeights(strokes.model(), fit));
}

/// Grams of the strokes whose samples are kept; of all strokes if none were to be kept.
std::vector<StrokeGram> UsedGrams(const LogStrokes& log) {
  std::vector<StrokeGram> grams = log.Grams();
  if (!log.stretches.empty()) grams.resize(log.stretches.size());
  return grams;
}

/// Sizes of the added effects as parameters of the model.
std::vector<Estimate> SizesOf(const ModelStructure& model, const ExtendedFit& fit) {
  std::vector<Estimate> out;
  for (const EffectEstimate& effect : fit.effects) {
    const Effect& law = *model.effects[effect.choice.effect];
    Estimate estimate;
    estimate.parameter = law.id + "." + law.parameter;
    estimate.unit = law.unit;
    estimate.value = effect.size;
    estimate.std = effect.std;
    estimate.excitation = effect.independent;
    estimate.reason = !effect.admissible          ? EstimateReason::kOutsidePhysics
                      : std::isfinite(effect.std) ? EstimateReason::kUpdated
                                                  : EstimateReason::kConfounded;
    out.push_back(std::move(estimate));
  }
  return out;
}

}  // namespace

std::vector<Estimate> BaseParameters(const ModelStructure& model, const ExtendedFit& fit, int strokes,
                                     Tolerances tolerances) {
  std::vector<Estimate> out;
  const Eigen::MatrixXd covariance = fit.covariance.topLeftCorner(model.base_count, model.base_count);
  const double student = StudentFactor(strokes - 1.0);
  for (const DerivedParameter& derived : model.derive(fit.theta.head(model.base_count))) {
    Estimate estimate;
    estimate.parameter = derived.name;
    estimate.unit = derived.unit;
    estimate.value = derived.value;
    const double variance = derived.gradient.dot(covariance * derived.gradient);
    const double geometry = tolerances == Tolerances::kHeld ? derived.geometry_std : 0.0;
    estimate.std = std::hypot(student * std::sqrt(NonNegative(variance)), geometry);
    estimate.reason = TrustOf(derived, estimate.std);
    out.push_back(std::move(estimate));
  }
  return out;
}

void MarkCarriedByError(const StrokeSet& strokes, const ExtendedFit& fit, GramFit& figures) {
  const ModelStructure& model = strokes.model();
  if (InEpisodes(*model.kind)) return;  // judged by their runs
  const Eigen::MatrixXd directions = ModelDirections(strokes, fit);
  const Eigen::MatrixXd integral = directions.transpose() * strokes.Total() * directions;
  NormalEquations flow{directions.transpose() * strokes.TotalFlow() * directions, {}, 0, 0};
  if (!(fit.rms_modelled > 0)) return;
  flow.equations = fit.theta.dot(flow.h * fit.theta) / (fit.rms_modelled * fit.rms_modelled);
  const auto carried = CarriedByError(integral, flow, fit.theta, fit.rms_holdout, fit.noise_floor);
  const Eigen::VectorXd excitation = Excitation(integral);
  const Eigen::VectorXd base = fit.theta.head(model.base_count);
  const std::vector<int> own = OwnParameters(model.derive(base), base);
  for (std::size_t i = 0; i < own.size(); ++i) {
    Estimate& e = figures.parameters[i];
    if (!carried[static_cast<std::size_t>(own[i])] || e.reason != EstimateReason::kUpdated) continue;
    e.reason = EstimateReason::kConfounded;
    e.excitation = excitation[own[i]];
  }
}

GramFit FiguresOf(const ModelStructure& model, const ExtendedFit& fit, int strokes) {
  GramFit figures;
  figures.theta = fit.theta;
  figures.covariance = fit.covariance;
  figures.parameters = BaseParameters(model, fit, strokes);
  for (Estimate& size : SizesOf(model, fit)) figures.parameters.push_back(std::move(size));
  figures.rms_measured = fit.rms_measured;
  figures.rms_modelled = fit.rms_modelled;
  figures.rms_residual = fit.rms_residual;
  figures.rms_holdout = fit.rms_holdout;
  figures.noise_floor = fit.noise_floor;
  figures.strokes = strokes;
  figures.indispensable_strokes = fit.indispensable_strokes;
  figures.clusters = fit.clusters;
  return figures;
}

Told WhyNotSolved(const ModelStructure& model, const LogStrokes& log) {
  if (!log.swapped.empty()) return log.swapped.front();
  return log.stuck.empty() ? WhyNotSolved(model, UsedGrams(log), log.window) : log.stuck;
}

Result<GramFit> FitFigures(const LogStrokes& log) {
  if (log.machine.added_effects.empty()) {
    auto fit = FitBaseModel(*log.model, UsedGrams(log), log.window);
    if (!fit && !log.strokes.empty()) return BadInput(WhyNotSolved(*log.model, log));
    return fit;
  }
  auto model = TRY(FitMachineModel(log));
  return std::move(model.figures);
}

Result<MachineModel> FitMachineModel(const LogStrokes& log) {
  auto structure = std::make_shared<ModelStructure>(*log.model);
  std::vector<EffectChoice> choices;
  if (!log.machine.added_effects.empty()) {
    AddSampleEffects(*structure, log.machine.added_effects);
    StrokeSet strokes = StrokesOfLogUnder(*structure, log);
    for (const std::string& id : log.machine.added_effects) {
      const auto effect = TRY(FindEffect(*structure, id));
      if (structure->effect_shapes[effect].empty() && SearchShape(log, strokes, choices, *structure))
        strokes = StrokesOfLogUnder(*structure, log);
      const EffectChoice best = strokes.BestShape(effect, choices);
      if (best.shape < 0)
        return BadInput(Tell(
            "these strokes cannot tell effect '{0}' of the machine file from the rest of the model: record "
            "strokes that differ in {1}, or take it out with 'hydroscope model remove {0}'",
            "diese Hübe können den Effekt '{0}' der Maschinendatei nicht vom Rest des Modells unterscheiden: Hübe "
            "aufzeichnen, die sich darin unterscheiden: {1}; oder ihn herausnehmen ('hydroscope model remove {0}')",
            id, structure->words.vary));
      choices.push_back(best);
    }
    const std::vector<StrokeStretches> derived = WithDerivedChannels(*structure, log.stretches);
    for (int pass = 0; pass < kPasses; ++pass)
      choices = RefineModel(*structure, derived, log.window, choices);
  }
  MachineModel out{structure, choices, {}, {}, {}};
  const StrokeSet strokes(structure,
                          choices.empty() ? UsedGrams(log) : GramsOf(structure, log.stretches, log.window),
                          log.window);
  out.fit = strokes.Fit(choices);
  if (!out.fit.solved) return BadInput(WhyNotSolved(*structure, log));
  out.trust = JudgeLog(log, out.fit.theta, out.fit.noise_floor);
  WidenByNonlinear(structure, log.stretches, log.window, choices, out.fit);
  strokes.Widen(choices, out.fit);
  if (!choices.empty()) {
    out.figures = FiguresOf(*structure, out.fit, static_cast<int>(log.stretches.size()));
    MarkCarriedByError(strokes, out.fit, out.figures);
    return out;
  }
  out.figures = TRY(FitFigures(log));
  return out;
}

}  // namespace hydroscope
