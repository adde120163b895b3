#pragma once

#include <string>
#include <utility>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// One signal of a machine of the user's own, and what strokes in turn are to be run at.
struct SignalLevels {
  std::string signal;
  bool speed = false;  ///< levels are those of the mean magnitude of its rate of change
  std::string unit;    ///< of the signal in the machine file; levels are SI
  /// Of its mean within a stroke, from ... to. Equal where [experiment] says that it may be set.
  std::vector<std::pair<double, double>> levels;
};

/// Strokes that tell rivals of a machine of the user's own apart, every combination of the levels in turn.
struct SignalExperiment {
  std::vector<SignalLevels> signals;  ///< empty: strokes like all of those recorded
  int strokes = 0;  ///< how many tell the rivals apart, together with those recorded; 0: none is proposed
  double separation = 0;  ///< noise variances between the two nearest rivals after them, or the most there is
  double separation_now = 0;        ///< ... and after those recorded
  double seconds = 0;               ///< inside the gate, of all strokes
  std::string tied;                 ///< signal that keeps the moves allowed from being computed, "" = none
  bool unusable = false;            ///< moves are allowed, and none of them can be used
  std::vector<std::string> inputs;  ///< signals that the effects in question and the balance's terms read

  /// Whether the separation is what a verdict takes; else it goes as far as the longest series can.
  bool settles() const;
};

/// What to record on a machine whose balance is the user's own. How such a machine answers to a move is in no
/// expression, so none is simulated. Regressors need no answer where only the output answers, that is where
/// no term and no effect in question reads a signal of `output`: then strokes recorded are shifted to other
/// levels of the signals under `experiment.signals` of the machine file and run through at other speeds, all
/// else staying as recorded, and the regressors are computed again. Everywhere else, and where nothing is
/// allowed, only strokes as they were recorded are trusted: all of them, and those of low, of high and of low
/// and high means and speeds of each signal. The separation is that of ProposeExperiment; its unit is the
/// sensor noise as recorded or, if more, what the explanation leaves. None is proposed if the explanation is
/// not ambiguous, or if the longest series stays below kExperiment.worthwhile.
SignalExperiment ProposeSignalExperiment(const Explanation& explanation, const Machine& machine,
                                         std::span<const StrokeStretches> recorded,
                                         const WindowSamples& window);

/// What to do, or why nothing can be proposed and what to do about that.
Told SignalExperimentText(const SignalExperiment& experiment);

}  // namespace hydroscope
