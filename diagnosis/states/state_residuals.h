#pragma once

#include <span>
#include <vector>

#include "diagnosis/remainder/residuals.h"
#include "diagnosis/states/remainder.h"

namespace hydroscope {

/// What errors of a free run are looked over: inputs as measured, states and outputs as simulated, and of episodes that are cycles
/// of a machine (three or more) the share of the cycle.
std::vector<ResidualSignal> RunSignals(const StateFit& fit);
/// ... at a row of an episode, SI.
std::vector<double> RunSignalsAt(const StateFit& fit, std::span<const Episode> episodes, std::size_t episode,
                                 int row);

/// What the free run of a fit leaves at the readings of one output, over RunSignals, for Locate. A stroke of it is a piece of the
/// log (StateFit::pieces), a window a reading; of many readings every so many. Noise is the share of the error that no function
/// predicts (`left`), even over the readings.
Residuals ResidualsOf(const StateFit& fit, std::span<const Episode> episodes, int output,
                      const StateRemainder& left);

}  // namespace hydroscope
