#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/linear_form.h"
#include "models/machine.h"

namespace hydroscope {

/// What a signal that is driven may do.
struct TrajectoryLimits {
  std::string signal;
  double low = 0, high = 0;            ///< SI
  double speed = 0, acceleration = 0;  ///< SI, largest magnitude
};

struct TrajectoryOptions {
  double period = 20;  ///< s, after which it repeats
  int terms = 5;       ///< sines and cosines of each signal
  int trials = 300;    ///< drawn, then changed a little at a time
  std::uint32_t seed = 1;
};

/// A signal as a finite Fourier series: centre + sum over k of sine[k] sin((k+1) w t) + cosine[k] cos((k+1) w t), w = 2 pi/period.
struct SignalSeries {
  std::string signal;
  double centre = 0;
  std::vector<double> sine, cosine;
  double Value(double time, double period) const;
};

struct Trajectory {
  double period = 0;
  std::vector<SignalSeries> signals;
  double condition = 0;            ///< of the scaled regressor over one period
  double first_condition = 0;      ///< of the first one drawn, for comparison
  std::vector<std::string> shown;  ///< parameters that it tells apart, BaseParameterText
};

/// A trajectory by which the parameters are told apart best (Swevers et al. 1997): of series within the limits the one whose
/// scaled base regressor has the smallest condition number. Equations of the form count that need no more than the driven
/// signals and their rates. Error: a limit is not a range, no equation is left.
Result<Trajectory> DesignTrajectory(const LinearForm& form, const Machine& machine,
                                    const std::vector<TrajectoryLimits>& limits,
                                    const TrajectoryOptions& options = {});

}  // namespace hydroscope
