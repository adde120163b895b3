#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/told.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else hold diagnosis/states/other_causes/initial_values_test.cc and
/// `hydroscope benchmark state-machines`.
struct InitialValuesOptions {
  int rows = 4000;      ///< of the fit's own episodes that they are tried on
  int iterations = 10;  ///< of each fit there
  /// Rms error over that with the values the model gives, below which they are told of.
  double less_error = 0.8;
};

/// Episodes that seem to begin elsewhere than the model says: a record cut out of one that had begun at rest.
struct OtherBeginning {
  std::vector<std::string> states;  ///< whose initial values the model gives
  double error = 1;                 ///< rms of the free run with them estimated, over that without
};

/// Of the episodes of a fit, which is repeated from where it ended with every initial value estimated. Nothing if it leaves no
/// clearly smaller error, or all were estimated.
std::optional<OtherBeginning> FindOtherBeginning(const StateFit& fit, std::span<const Episode> episodes,
                                                 const InitialValuesOptions& options = {});

/// Of episodes that the parameters were not fitted to (FollowStates), in all their rows; the parameters stay.
std::optional<OtherBeginning> FindOtherBeginningHeldOut(const StateFit& fit,
                                                        std::span<const Episode> episodes,
                                                        const InitialValuesOptions& options = {});

/// A sentence that says so; `record`: what the episodes are called.
Told OtherBeginningText(const OtherBeginning& other, const Told& record);

}  // namespace hydroscope
