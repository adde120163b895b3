#pragma once

#include <span>
#include <string>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// What the machine may be asked to do.
struct MachineMoves {
  double speed_min = 0.02, speed_max = 0.12;        ///< m/s, ram speeds
  double pressure_min = 40e5, pressure_max = 200e5; ///< Pa, cushion pressures
  double stroke = 0.19;                             ///< m
  double warm_up = 15.0;                            ///< K by which the oil may be warmed between strokes; 0 = not
};

/// A series of strokes, half of them at each speed, each stepping through the pressures.
struct Experiment {
  double speed_low = 0, speed_high = 0;              ///< m/s
  std::vector<double> pressures;                     ///< Pa, one after the other within a stroke
  double warm_up = 0;                                ///< K between the first and the last stroke
  int strokes = 0;                                   ///< how many tell the rivals apart
  double separation = 0;                             ///< noise variances per stroke between the two nearest rivals
};

/// Among the moves allowed, the series of strokes that tells the rivals apart best: each candidate is played through
/// with the fitted base model, every rival with its fitted size, and the part of their difference that neither the base
/// parameters nor the strokes already recorded can swallow is weighed against the sensor noise.
/// `rivals` are the fits of the effects in the set. Empty pressures if nothing would help.
Experiment ProposeExperiment(const StrokeSet& recorded, std::span<const RankedEffect> rivals, double noise_variance,
                             const MachineMoves& moves, const WindowSamples& window);

/// One or two sentences for the person at the machine.
std::string ExperimentText(const Experiment& experiment);

}  // namespace hydroscope
