#pragma once

#include <optional>
#include <vector>

#include "diagnosis/refine.h"

namespace hydroscope {

/// Pressure of one stroke as the model runs it by itself.
struct FreeRunStroke {
  std::vector<double> measured, simulated;  ///< Pa, block means
  double rms = 0;                           ///< Pa, of measured - simulated
};

/// Simulates the cushion pressure p_A of every stroke from the model, with the measured position and spool
/// position, from the stroke's first pressure on: where the balance compares flows at the measured pressure,
/// here every error piles up as it does in the machine. Sample by sample the pressure is found at which the
/// balance over the sample closes (implicit trapezoidal rule). After a gap in the samples it starts again.
/// Derived channels other than the flow root, such as smoothed speed and pressure rate, are those of the
/// measurement. `weights`: modelled output = weights . columns. nullopt for a model without such a pressure.
std::optional<std::vector<FreeRunStroke>> FreeRun(const ModelStructure& model,
                                                  std::span<const StrokeStretches> strokes,
                                                  const WindowSamples& window,
                                                  const Eigen::VectorXd& weights);

}  // namespace hydroscope
