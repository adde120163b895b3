#pragma once

#include <cstddef>
#include <span>

#include "diagnosis/states/explain_states.h"

namespace hydroscope {

/// The model as it is, fitted to these episodes, and what it leaves. Starts are tried on `start_episodes` of them, spread over
/// all.
StatesExplanation FitAsItIs(const Machine& machine, std::span<const Episode> episodes,
                            std::size_t start_episodes, const ExplainStatesOptions& options);

/// Searches the sets of effects that explain what it leaves; `as_it_is` comes from FitAsItIs with the same arguments.
StatesExplanation SearchEffects(const Machine& machine, std::span<const Episode> episodes,
                                std::size_t start_episodes, const ExplainStatesOptions& options,
                                StatesExplanation as_it_is);

}  // namespace hydroscope
