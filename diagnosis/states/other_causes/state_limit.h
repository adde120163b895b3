#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/told.h"
#include "estimation/states/fit.h"

namespace hydroscope {

/// That it is found where it is and told of nowhere else hold diagnosis/states/other_causes/state_limit_test.cc and
/// `hydroscope benchmark state-machines`.
struct StateLimitOptions {
  int rows = 4000;            ///< that fits without a limit are tried on
  double least_share = 0.01;  ///< of the rows, at which a state must stand at a limit for it to be tried
  double less_error = 0.5;    ///< rms error without the limit over that with it, below which it is told of
};

/// A limit of the machine file that the model stands at where the machine goes on.
struct DoubtedLimit {
  std::string state;
  bool upper = true;  ///< max, else min
  double at = 0;      ///< SI
  double share = 0;   ///< of the rows, at which the state stands there
  /// Rms of what is left without it, over that with it; of several outputs the mean of squares.
  double error = 1;
};

/// The limit without which least is left, if that is clearly less: the fit is repeated without each limit that states stand at.
/// About a wrong one no fit follows the machine, and what moves readings past it looks like a law that is missing.
std::optional<DoubtedLimit> FindDoubtedLimit(const StateFit& fit, std::span<const Episode> episodes,
                                             const StateLimitOptions& options = {});

/// A sentence that says so.
Told DoubtedLimitText(const DoubtedLimit& limit);

}  // namespace hydroscope
