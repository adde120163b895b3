#pragma once

#include <string>
#include <vector>

#include "diagnosis/locate.h"
#include "diagnosis/whiteness.h"
#include "service/machine_model.h"

namespace hydroscope {

/// Measured against modelled flow of one stroke, m^3/s.
struct StrokeComparison {
  std::int64_t stroke = 0;  ///< index within the log, 0, 1, ...
  double begin = 0;         ///< s
  int windows = 0;
  double rms_measured = 0, rms_modelled = 0, rms_residual = 0, noise_floor = 0;
};

/// Everything `hydroscope compare` knows of one log.
struct CompareResult {
  LogStrokes log;
  std::size_t strokes = 0;  ///< compared: those whose samples were kept
  MachineModel model;
  Residuals residuals;
  StrokeComparison overall;
  std::vector<StrokeComparison> per_stroke;
  Whiteness whiteness;
  std::vector<SignalCorrelation> correlations;
  ErrorLocation location;

  /// Index into per_stroke of the stroke with the largest error above its noise.
  std::size_t WorstStroke() const;
};

/// Fits the machine file's model (base and added effects) to the log and compares it with the measurement.
/// Errors: log or machine file are wrong, fewer than two strokes, or strokes that do not excite the model.
Result<CompareResult> CompareLog(const std::string& log, const std::string& machine_file);

}  // namespace hydroscope
