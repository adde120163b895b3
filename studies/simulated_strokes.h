#pragma once

#include "core/result.h"
#include "pipeline/batch_fit.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {

/// The machine file that fits a simulated cylinder: example press, geometry from the options.
Machine MachineFor(const PressOptions& options);

/// A simulated log as the pipeline's rows, all good.
SampleBlock RowsOf(const SimulatedLog& log, const Machine& machine);

/// Sends a simulated log through time check, quality monitor and pipeline, as a log file would go. `tap` is for samples not kept.
Result<LogStrokes> StrokesOf(const SimulatedLog& log, const Machine& machine,
                             KeepSamples keep = KeepSamples::kNo, const Pipeline::EquationTap& tap = {});

}  // namespace hydroscope
