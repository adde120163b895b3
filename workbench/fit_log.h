#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "pipeline/geometry_tolerance.h"
#include "workbench/explain/confounding.h"
#include "workbench/fit_suspicion.h"
#include "workbench/held_out_log.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {

struct FitResult {
  LogStrokes log;  ///< with the samples kept
  GramFit fit;     ///< ExplainResult::base: base balance and the effects added to it, odd strokes left out
  FitSuspicion suspicion;
  LogTrust trust = {};
  std::vector<Confounding> confounded = {};
  std::vector<AssumedTolerance> assumed = {};  ///< tolerances of the geometry that the intervals rest on
  std::optional<HeldOutError> held_out = {};   ///< on the log that was held out
};

/// The model of `strokes.machine` fitted to strokes that were read with their samples, and what to suspect of
/// it; those too few for a verdict are fitted all the same. Error: they do not excite the model.
Result<FitResult> FitStrokes(LogStrokes strokes);

/// `hydroscope fit`: the model of the machine file fitted to logs of one machine, every equation of which
/// weighs the same; its error is also given on the log `hold_out` (path or file name, "" = none), which it is
/// not fitted to. Errors: a log or the machine file is wrong, an added effect is not known, strokes do not
/// excite the model.
Result<FitResult> FitLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                          const std::string& hold_out = {});

}  // namespace hydroscope
