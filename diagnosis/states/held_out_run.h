#pragma once

#include <span>
#include <string>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// When a run over a log held out is worth a sentence; none of them decides a verdict.
struct HeldOutRunOptions {
  int rows = 50;           ///< of a short run
  double more = 1.5;       ///< error over the fit's from which on a cause is looked for
  double as_fitted = 1.2;  ///< ... below which a run errs as it does on the log fitted
  /// Of a state's range, by which its run begins elsewhere where it is asked whether that grows.
  double moved = 1e-4;
  /// Largest difference of the states over a short run's rows, over that of the first ones, from which on it does: far more than a
  /// state that is not measured takes to reach those that are, far less than what a swing that loses its phase grows to.
  double magnified = 10;
  double beyond = 0.05;  ///< of the fitted range of a signal: less beyond it counts as within
  /// Share of an output's energy that a constant takes away if its zero has moved; of what drifts off at random it is less.
  double constant_share = 0.8;
};

/// What a free run over a log held out says of a model, beyond how much it errs.
struct HeldOutRun {
  /// A signal that leaves the range it had in the log fitted, SI.
  struct Beyond {
    std::string signal;
    double fitted_low = 0, fitted_high = 0, low = 0, high = 0;
  };
  double error = 0;  ///< rms over that of the log fitted, of the worst output
  /// The same of short runs with initial states of their own; 0: none were needed or possible.
  double short_error = 0;
  /// Short runs err as on the log fitted, the long one does not.
  bool loses_its_way = false;
  bool magnifies = false;      ///< ... since small differences of where it begins grow in it
  std::vector<Beyond> beyond;  ///< where the run errs by more than on the log fitted
  /// An output whose error is a constant, SI: measured less modelled.
  struct Constant {
    std::string signal;
    double by = 0, share = 0;  ///< of the error's energy
  };
  std::vector<Constant> constant;
};

/// `followed`: FollowStates of `fit` on the episodes held out.
HeldOutRun LookAtHeldOut(const StateFit& fit, std::span<const Episode> fitted, const StateFit& followed,
                         std::span<const Episode> held_out, const HeldOutRunOptions& options = {});

/// A sentence for each thing that it says; `log`: what was held out.
std::vector<Told> HeldOutTexts(const HeldOutRun& run, const StateModel& model, const std::string& log,
                               const HeldOutRunOptions& options = {});

}  // namespace hydroscope
