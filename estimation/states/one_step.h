#pragma once

#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// Error of one step over that of the free run, below which a log that no function of states and inputs explains any better
/// is taken for one whose process itself is noisy.
inline constexpr double kSlowError = 0.5;

/// Rms of an output's error where a regression on the last few errors may be used: innovations of an autoregressive noise
/// model (Box and Jenkins 1970).
double OneStepError(const StateFit& fit, int output);

/// Those innovations, in the output's unit, per episode and row; NaN where a past error is not known.
std::vector<Eigen::VectorXd> Innovations(const StateFit& fit, int output);

/// Energy of the error that past errors do not foresee, of that of the error, each output over its noise.
double OneStepShare(const StateFit& fit);

}  // namespace hydroscope
