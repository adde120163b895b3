#pragma once

#include <memory>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "service/batch_fit.h"
#include "service/log_trust.h"

namespace hydroscope {

/// The model of a machine file as fitted to a log: base and the effects added to it (Machine::added_effects).
struct MachineModel {
  std::shared_ptr<const ModelStructure> structure;  ///< has the shapes that `choices` name
  std::vector<EffectChoice> choices;                ///< in order of adding
  ExtendedFit fit;
  LogTrust trust = {};  ///< what makes conclusions from the log doubtful; nothing without samples
};

/// Fits it to the kept strokes; nonlinear parameters of added effects come from the best grid value, refined.
/// Where an effect has free ones, standard deviations hold what their own scatter adds.
/// Errors: an added effect is not in the library or its signal is not measured; the strokes cannot separate
/// the parameters.
Result<MachineModel> FitMachineModel(const LogStrokes& log);

/// Index of an effect in the model's library. Error: unknown id (names the nearest one) or a signal is
/// missing.
Result<int> FindEffect(const ModelStructure& model, const std::string& id);

}  // namespace hydroscope
