#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "service/confounding.h"
#include "service/geometry_tolerance.h"
#include "service/machine_model.h"

namespace hydroscope {

struct FitResult {
  LogStrokes log;  ///< with the samples kept
  GramFit fit;     ///< MachineModel::figures: base balance and the effects added to it
  std::vector<Confounding> confounded;
  std::vector<AssumedTolerance> assumed;  ///< tolerances of the geometry that the intervals rest on
  bool too_slow = false;                  ///< rows too far apart: no parameter can be trusted (LogTrust)
};

/// `hydroscope fit`: the model of the machine file fitted to a log, every equation of which weighs the same.
/// Errors: log or machine file are wrong, an added effect is not known, strokes do not excite the model.
Result<FitResult> FitLog(const std::string& log, const std::string& machine_file);

}  // namespace hydroscope
