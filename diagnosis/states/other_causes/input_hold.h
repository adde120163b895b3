#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/told.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else hold diagnosis/states/other_causes/input_hold_test.cc and
/// `hydroscope benchmark state-machines`.
struct InputHoldOptions {
  int rows = 4000;          ///< that the other ways are tried on
  int iterations = 10;      ///< of each fit
  double less_error = 0.8;  ///< rms error over that of the way the file says, below which another is told of
};

/// Inputs that seem to move between rows in another way than `[log] hold` says.
struct OtherHold {
  InputHold hold = InputHold::kLinear;
  /// Rms of what is left with it, over that without; of several outputs the mean of squares.
  double error = 1;
};

/// The way that leaves least, if it leaves clearly less than that of the machine file: the fit is repeated with each from where
/// it ended. What a wrong one leaves looks like a law that is missing.
std::optional<OtherHold> FindOtherHold(const StateFit& fit, std::span<const Episode> episodes,
                                       const InputHoldOptions& options = {});

/// A sentence that says so.
Told OtherHoldText(const OtherHold& other);
/// The same where the other way was taken.
Told TakenHoldText(const OtherHold& taken);

}  // namespace hydroscope
