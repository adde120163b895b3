#pragma once

#include <optional>
#include <span>

#include "estimation/states/fit.h"

namespace hydroscope {

/// That they are told of nowhere where noise acts on the process evenly, and found where it does not, holds error_bursts_test.cc.
struct ErrorBurstsOptions {
  int lags = 4;         ///< rows over which large innovations keep together
  double max_p = 1e-6;  ///< that noise of one strength keeps them together as much
  int rows = 16;        ///< of the place that is told
};

/// What past errors do not foresee of an output's error is large at some times and small at others.
struct ErrorBursts {
  double p_value = 1;
  double from = 0, to = 0;  ///< s, of the strongest
};

/// Whether innovations (Box and Jenkins 1970) of the error come in bursts: their squares are correlated from row to row (portmanteau
/// statistic of McLeod and Li 1983). Noise of one strength scatters them evenly, on sensors or on the process; a law that acts
/// seldom, or a disturbance, does not. Of several outputs the one that shows it most.
std::optional<ErrorBursts> FindErrorBursts(const StateFit& fit, std::span<const Episode> episodes,
                                           const ErrorBurstsOptions& options = {});

}  // namespace hydroscope
