#pragma once

#include <string>

#include "models/model_history.h"
#include "pipeline/batch_fit.h"
#include "workbench/history/stroke_history.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {

/// What a machine's model achieves, and the nonlinear parameters its effects came out with.
struct ModelEvidence {
  ModelRecord record;
  std::map<std::string, std::map<std::string, double>> effect_values = {};
  std::vector<std::string> outside_physics = {};  ///< parameters whose value physics forbids
  Eigen::VectorXd excess = {};                    ///< ExtendedFit::excess of the strokes; empty: not known
};

/// Judges the model of `machine` (base and added effects) on the strokes of a log. Errors: as FitMachineModel.
Result<ModelEvidence> JudgeModel(const Machine& machine, LogStrokes strokes, const std::string& source);

/// The same on stored strokes; nonlinear parameters come from the grid of the library, interpolated.
Result<ModelEvidence> JudgeModel(const Machine& machine, const StrokeHistory& history);

/// Fits the model of `machine` to stored strokes. Errors: an effect is not in the library, or the strokes
/// cannot separate the parameters.
Result<MachineModel> FitHistoryModel(const Machine& machine, const StrokeHistory& history);

/// "base + internal_leakage".
std::string ModelName(const Machine& machine);

}  // namespace hydroscope
