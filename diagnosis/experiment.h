#pragma once

#include <string>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// What the machine may be asked to do.
struct MachineMoves {
  double speed_min = 0.02, speed_max = 0.12;         ///< m/s, ram speeds
  double pressure_min = 40e5, pressure_max = 200e5;  ///< Pa, cushion pressures
  double stroke = 0.19;                              ///< m
  double min_opening = 0.0;                          ///< spool position below which the gate shuts
  double warm_up = 0.0;                              ///< K by which the oil may warm between strokes; 0 = not
  int max_strokes = 200;                             ///< longest series worth asking for
};

/// The limits the machine file gives; what it leaves out is taken from the strokes recorded.
MachineMoves MovesOf(const Machine& machine, std::span<const StrokeStretches> strokes);

/// A series of strokes at the speeds in turn, each stepping through the pressures in equal parts.
struct Experiment {
  std::vector<double> speeds;     ///< m/s, one stroke after the other
  std::vector<double> pressures;  ///< Pa, one after the other within a stroke; empty: nothing would help
  double warm_up = 0;             ///< K between the first and the last stroke
  int strokes = 0;                ///< how many tell the rivals apart
  double separation = 0;          ///< noise variances per stroke between the two nearest rivals
  double seconds = 0;             ///< drawing time of all strokes
};

/// The effects between which an ambiguous explanation cannot decide, as fitted.
std::vector<RankedEffect> RivalsOf(const Explanation& explanation);

/// Among the moves allowed, the series of strokes that tells the rivals apart best: each candidate is played
/// through with the fitted base model, every rival with its fitted size, and the part of their difference
/// that neither the base parameters nor the other rival can swallow is weighed against the sensor noise.
/// Empty pressures if the explanation is not ambiguous, or if no series of at most max_strokes would settle
/// it.
Experiment ProposeExperiment(const Explanation& explanation, const MachineMoves& moves,
                             const WindowSamples& window);

/// One or two sentences for the person at the machine.
std::string ExperimentText(const Experiment& experiment);

}  // namespace hydroscope
