#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/states/candidate_fits.h"
#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/set_comparison.h"
#include "diagnosis/states/spread_pieces.h"

namespace hydroscope {

/// The sets of effects that a search has found: what its verdict is concluded from.
struct FoundSets {
  /// All must outlive this; starts are tried on `start_episodes` of the episodes, spread over all.
  FoundSets(const Machine& of, std::span<const Episode> in, std::size_t start_episodes,
            const ExplainStatesOptions& with)
      : machine(of),
        episodes(in),
        options(with),
        compare(with),
        starts_on(SpreadOver(in.size(), start_episodes)) {}

  StateRemainder Left(const StateFit& fit) const { return RemainderOf(fit, episodes, options.remainder); }
  /// The set found with an effect taken out, fitted from there.
  const StateCandidate& Without(const std::string& id);

  const Machine& machine;
  std::span<const Episode> episodes;
  const ExplainStatesOptions& options;
  const SetComparison compare;
  const std::vector<std::size_t> starts_on;                    ///< episodes that starts are tried on
  std::optional<CandidateFits> fits;                           ///< once the base is fitted
  std::vector<std::vector<StateCandidate>> levels;             ///< per number of effects, sets best first
  std::map<std::vector<std::string>, StateCandidate> without;  ///< of the set found, as far as fitted
  StatesExplanation out;                                       ///< `final`: the set found
};

}  // namespace hydroscope
