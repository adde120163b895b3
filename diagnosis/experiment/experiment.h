#pragma once

#include <string>
#include <vector>

#include "diagnosis/experiment/machine_moves.h"
#include "diagnosis/explain.h"

namespace hydroscope {

/// A series of strokes at the speeds in turn, each stepping through the pressures in equal parts; after each
/// round of speeds chamber B takes its next pressure.
struct Experiment {
  std::vector<double> speeds;          ///< m/s, one stroke after the other
  std::vector<double> pressures;       ///< Pa, one after the other within a stroke; empty: nothing would help
  std::vector<double> rod;             ///< Pa, of chamber B; empty: as it is
  double warm_up = 0;                  ///< K between the first and the last stroke
  int strokes = 0;                     ///< how many tell the rivals apart, together with those recorded
  double separation = 0;               ///< noise variances between the two nearest rivals after them
  double seconds = 0;                  ///< drawing time of all strokes
  std::vector<std::string> left = {};  ///< ids of rivals that no series of these moves tells from another one

  /// Whether the separation is what a verdict takes; else it goes as far as the longest series can.
  bool settles() const;
};

/// Among the moves allowed, the shortest series of strokes that tells the rivals of every group apart which strokes can tell
/// apart at all, explained together with the strokes `recorded` (T-optimal design after Atkinson and Fedorov 1975, over a list of candidates):
/// each candidate is played through with the fitted base model, every rival with its fitted size, and the
/// part of their difference that neither the base parameters nor the other rival can swallow is weighed
/// against the sensor noise. Where no series of at most max_strokes settles it, the one that goes furthest.
/// Empty pressures if the explanation is not ambiguous or nothing helps; a test off the log may (Effect::measured_by).
Experiment ProposeExperiment(const Explanation& explanation, const MachineMoves& moves,
                             std::span<const StrokeStretches> recorded, const WindowSamples& window);

/// One or two sentences for the person at the machine.
std::string ExperimentText(const Experiment& experiment);

}  // namespace hydroscope
