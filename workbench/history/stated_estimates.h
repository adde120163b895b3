#pragma once

#include <vector>

#include "estimation/gram_fit.h"
#include "models/machine.h"
#include "pipeline/geometry_tolerance.h"
#include "storage/database.h"
#include "workbench/explain/confounding.h"

namespace hydroscope {

/// What the estimates a database holds are stated with, as `fit` states those of a log. The estimator follows changes, so what
/// all strokes share is not in its intervals, and it does not ask for effects that the strokes could not show.
struct StatedEstimates {
  GramFit figures = {};  ///< fit to the last run (of very many strokes, the last ones); all 0: none
  bool floor_known =
      true;  ///< whether anybody looked what the noise of the last run is like: else its floor is that of white noise
  std::vector<Confounding> confounded;  ///< over the newest strokes, of whatever run: the estimator remembers
  std::vector<AssumedTolerance> assumed;  ///< tolerances of the geometry that the intervals rest on
  /// All of this for each parameter of the model, as it holds for the strokes that follow.
  std::vector<EstimateStatement> statements;
  std::vector<Told> unusual;  ///< DoubtsOfNewest, of these estimates, as `fit` and `explain` warn of them
};

/// Widens the estimates `latest`, one per parameter after the last stroke of the machine, and marks them. Widened by a
/// tolerance that was assumed, and, where the strokes of the last run hang together, to no less than the fit to them; marked
/// as confounded where an effect that the newest strokes could not show would move the value out of its interval. `model` is
/// that of `machine`, `runs` are all of the machine.
Result<StatedEstimates> StateEstimates(const Database& database, std::int64_t machine_id,
                                       const Machine& machine, const ModelStructure& model,
                                       const std::vector<RunInfo>& runs, std::vector<Estimate>& latest);

}  // namespace hydroscope
