#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "estimation/states/fit.h"
#include "simulator/flexible_axis/log.h"

namespace hydroscope {

struct FlexibleAxisStudyOptions {
  int machines = 20;
  std::uint64_t seed = 1;
  int starts = 9;        ///< at most, of each machine
  bool effects = false;  ///< hide each effect in turn, and explain
  std::string only;      ///< ... this one alone, "-": none; "" = all
};

/// The machine file of the simulated axis, as machines/flexible_axis.toml.
Machine FlexibleAxisFile();
/// The log as one episode of that machine.
Episode FlexibleAxisEpisode(const FlexibleAxisLog& log);
/// The parameters that a fit should find, in the order of the model's.
Eigen::VectorXd FlexibleAxisParameters(const FlexibleAxisMachine& machine);
/// The model with ranges of a factor of ten around `truth`, from which all starts are drawn.
std::shared_ptr<const StateModel> StartedWithinTen(const StateModel& model, const Eigen::VectorXd& truth,
                                                   std::uint64_t seed);
/// Squares of the errors over the sensors' noise.
double ChiSquare(const StateFit& fit, const AxisSensors& sensors);

/// Prints one line per random machine, driven by the staircase: starts needed, time, cost above the best; then what a fit of the
/// published one leaves of manoeuvres it has not seen. 0 if 19 of 20 are within 20 of the best and next to nothing but noise is
/// left; with `effects`: if 95 % are named first and at most 1 % wrongly.
int RunFlexibleAxisStudy(const FlexibleAxisStudyOptions& options);

}  // namespace hydroscope
