#pragma once

#include "estimation/states/simulation.h"
#include "models/machine.h"
#include "simulator/manipulator/manipulator.h"

namespace hydroscope {

/// The machine file a user of the simulated manipulator would have: geometry from its drawings. `rigid_known`: with the base
/// parameters of `known`, as identified before.
Machine ManipulatorMachine(const ManipulatorTruth& truth, const ControllerModel* known = nullptr);
/// The log as one episode.
Episode EpisodeOf(const ManipulatorLog& log);

/// What was identified, as the controller takes it; what is not among the names stays as it is.
ControllerModel WithIdentified(ControllerModel model, const std::vector<std::string>& names,
                               const Eigen::VectorXd& values);

}  // namespace hydroscope
