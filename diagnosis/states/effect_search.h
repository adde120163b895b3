#pragma once

#include <cstddef>
#include <span>

#include "diagnosis/states/explain_states.h"

namespace hydroscope {

/// Fits the model as it is to these episodes and searches the sets of effects that explain what it leaves. Starts are tried on
/// `start_episodes` of them, spread over all.
StatesExplanation SearchEffects(const Machine& machine, std::span<const Episode> episodes,
                                std::size_t start_episodes, const ExplainStatesOptions& options);

}  // namespace hydroscope
