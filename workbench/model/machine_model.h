#pragma once

#include <memory>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "pipeline/batch_fit.h"
#include "pipeline/log_trust.h"

namespace hydroscope {

/// The model of a machine file as fitted to a log: base and the effects added to it (Machine::added_effects).
struct MachineModel {
  std::shared_ptr<const ModelStructure> structure;  ///< has the shapes that `choices` name
  std::vector<EffectChoice> choices;                ///< in order of adding
  ExtendedFit fit;
  LogTrust trust = {};  ///< what makes conclusions from the log doubtful; nothing without samples
  /// What every command prints of it: theta as in `fit`; parameters are the physical ones of the base balance,
  /// then the size of each added effect as "internal_leakage.G".
  GramFit figures;
};

/// Fits it to the kept strokes; nonlinear parameters of added effects come from the best grid value, refined.
/// Where an effect has free ones, standard deviations hold what their own scatter adds.
/// Errors: an added effect is not in the library or its signal is not measured; the strokes cannot separate
/// the parameters.
Result<MachineModel> FitMachineModel(const LogStrokes& log);

/// Why a model has no fit to a log: what its readings say of themselves comes before what the strokes lack.
Told WhyNotSolved(const ModelStructure& model, const LogStrokes& log);

/// MachineModel::figures of a log. Without added effects no samples need be kept: all strokes of the log count.
Result<GramFit> FitFigures(const LogStrokes& log);

/// MachineModel::figures from the fit of a model with added effects to `strokes` independent units.
GramFit FiguresOf(const ModelStructure& model, const ExtendedFit& fit, int strokes);

/// Takes the trust from base parameters that a structured error of the size left could be taken for
/// (estimation/error_trust.h); their excitation says why.
void MarkCarriedByError(const StrokeSet& strokes, const ExtendedFit& fit, GramFit& figures);

/// Whether intervals hold the tolerances of the geometry. What all strokes of a machine share is no change: two fits of
/// it are compared without.
enum class Tolerances { kHeld, kLeftOut };

/// Physical base parameters of an extended fit, SI, as FitBaseModel gives them for the base model.
std::vector<Estimate> BaseParameters(const ModelStructure& model, const ExtendedFit& fit, int strokes,
                                     Tolerances tolerances = Tolerances::kHeld);

}  // namespace hydroscope
