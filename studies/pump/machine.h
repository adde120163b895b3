#pragma once

#include "estimation/states/fit.h"
#include "simulator/pump/log.h"

namespace hydroscope {

/// The machine file of the simulated pump, as machines/pump.toml; `control`: with both sensors of the control chamber.
Machine PumpFile(bool control);
/// The published model, linear about 0.7 of the stroke and 85 % of the speed, as a machine file of its own.
Machine LinearPumpFile();
/// The log as one episode of such a machine, its ripple taken out as of any log.
Episode PumpEpisode(const PumpLog& log, const Machine& machine);
/// The parameters that a fit should find, in the order of the model's.
Eigen::VectorXd PumpParameters(const PumpOptions& options);

/// %: 100 (1 - error/variation) of the outlet pressure, as published.
double PumpFit(const StateFit& fit);

}  // namespace hydroscope
