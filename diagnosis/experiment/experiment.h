#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/explain.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// A series of strokes that a machine of a kind with ExperimentRules is to be run at.
struct Experiment {
  const MachineKind* kind = nullptr;
  StrokeSeries levels = {};
  int strokes = 0;  ///< how many tell the rivals apart, together with those recorded; 0: nothing would help
  double separation = 0;               ///< noise variances between the two nearest rivals after them
  double seconds = 0;                  ///< inside the gate, of all strokes
  std::vector<std::string> left = {};  ///< ids of rivals that no series allowed tells from another one

  bool proposed() const { return strokes > 0; }
  /// Whether the separation is what a verdict takes; else it goes as far as the longest series can.
  bool settles() const;
  /// Of the setting with this key (StrokeSetting); none: as recorded.
  const std::vector<double>& Levels(std::string_view setting) const;
};

/// Among the series that the machine may be asked for, the shortest that tells the rivals of every group apart which strokes can
/// tell apart at all, explained together with the strokes `recorded` (T-optimal design after Atkinson and Fedorov 1975, over a
/// list of candidates): each candidate is played through with the fitted base model, every rival with its fitted size, and the
/// part of their difference that neither the base parameters nor the other rival can swallow is weighed
/// against the sensor noise. Where no series of at most max_strokes settles it, the one that goes furthest.
/// None if the explanation is not ambiguous, the kind of machine has no ExperimentRules or nothing helps; a test off the log
/// may (Effect::measured_by).
Experiment ProposeExperiment(const Explanation& explanation, const Machine& machine,
                             std::span<const StrokeStretches> recorded, const WindowSamples& window);

/// One or two sentences for the person at the machine.
Told ExperimentText(const Experiment& experiment);

}  // namespace hydroscope
