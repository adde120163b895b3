#pragma once

#include "estimation/recursive/episode_model.h"
#include "models/state_model.h"

namespace hydroscope {

/// Episodes of a machine with states: the first one is fitted by free runs (FitStates), each one after simulated with its
/// sensitivities, its initial states estimated (FollowStates).
std::shared_ptr<const EpisodeModel> EpisodesOfStates(std::shared_ptr<const StateModel> states);

}  // namespace hydroscope
