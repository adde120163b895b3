#pragma once

#include <optional>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// The channel of ModelStructure::free_run over one stroke as the model runs it by itself.
struct FreeRunStroke {
  std::vector<double> measured, simulated;  ///< SI, block means
  double rms = 0;                           ///< SI, of measured - simulated
};

/// Simulates ModelStructure::free_run of every stroke (a cushion's pressure), all other signals as measured, from the
/// stroke's first value on: where the balance compares outputs at the measured value, here every error piles up as it
/// does in the machine. Sample by sample the value is found at which the balance over the sample closes (implicit
/// trapezoidal rule). After a gap in the samples it starts again. `weights`: modelled output = weights . columns.
/// nullopt for a model without such a channel.
std::optional<std::vector<FreeRunStroke>> FreeRun(const ModelStructure& model,
                                                  std::span<const StrokeStretches> strokes,
                                                  const WindowSamples& window,
                                                  const Eigen::VectorXd& weights);

}  // namespace hydroscope
