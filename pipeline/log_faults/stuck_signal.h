#pragma once

#include "core/told.h"
#include "models/machine.h"
#include "models/model_structure.h"
#include "pipeline/run_summary.h"

namespace hydroscope {

/// Why strokes tell nothing where a signal that the model needs was stuck in most rows of a log: "y_v (column y_v): one and
/// the same reading in 70 % of the rows; is the sensor connected?". "" if none was.
Told StuckSignal(const RunSummary& summary, const Machine& machine, const ModelStructure& model);

}  // namespace hydroscope
