#pragma once

#include "core/result.h"
#include "estimation/closed_loop/transfer_fit.h"
#include "estimation/recursive/episode_model.h"

namespace hydroscope {

/// The transfer function that a machine in closed loop (ClosedLoopOf is not nullptr) is measured by. `sample_period` in s.
TransferModel TransferModelOf(const Machine& machine, double sample_period);
/// What its file calls healthy, as LoopOptions::known.
std::vector<double> ReferencesOf(const Machine& machine);

/// Episodes of such a machine: records that are each measured by themselves. The first one is fitted from all starts, poles
/// shared out as the references of the file have them (FitTransfer, NearestWay); each one after is linearised about the
/// parameters as they are (LineariseTransfer), with slopes at the basis until the gain or a pole has moved far from it. An episode
/// says nothing that is too short for averaged spectra, or whose set point is not excited. An input that is cut off passes for a
/// lower gain; that and what else keeps a part of it from plant or log (FindInputRange) is what makes an episode doubtful.
std::shared_ptr<const EpisodeModel> EpisodesOfLoop(const Machine& machine, double sample_period);

}  // namespace hydroscope
