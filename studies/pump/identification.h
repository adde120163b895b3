#pragma once

#include "studies/pump/benchmark.h"
#include "studies/pump/machine.h"

namespace hydroscope {

/// What a fit found of a parameter, in its unit.
struct FoundParameter {
  std::string name;
  double truth = 0, estimate = 0, standard_error = 0;
  double RelativeError() const { return estimate / truth - 1; }
  double StandardErrorsOff() const { return (estimate - truth) / standard_error; }
};

/// One random pump, fitted in each way. Fits in % of the outlet pressure's variation.
struct PumpCase {
  double ripple = 0, ripple_left = 0,
         ripple_smoothed = 0;  ///< Pa rms: raw, over revolutions, by the published filter
  struct Fits {
    bool solved = false;
    double log = 0, pulse = 0;  ///< %; of the record that was fitted, of a flow pulse that was not
    StateFit fit;
  };
  Fits all, outlet, linear;  ///< all sensors, outlet pressure alone, the published linear model on that
  std::vector<FoundParameter> found,
      found_outlet;                   ///< with all sensors, with that alone; empty: there is no fit
  std::vector<std::string> together;  ///< parameters that the outlet pressure alone does not tell
  std::vector<std::string> sensors;   ///< that are named for them
  double seconds = 0;                 ///< CPU time of the fit with all sensors
};
PumpCase FitPump(const PumpOptions& options);

/// Prints one line per pump and what they come to. True if the goals are reached.
bool PrintPumpIdentification(const PumpBenchmarkOptions& options);

}  // namespace hydroscope
