#pragma once

#include <optional>
#include <span>

#include "diagnosis/states/state_candidate.h"

namespace hydroscope {

/// Of a search: more finds the same and takes longer. Whether laws are one is ExplainStatesOptions::same_law.
struct NearestLawOptions {
  int rows = 400;   ///< spread over the episodes, that terms are compared at
  int draws = 200;  ///< of the effects' parameters from their ranges
  int kept = 3;     ///< of them, from which the nearest is sought
  int iterations = 50;
  std::uint32_t seed = 1;
};

/// Parameters at which the effects of a model come nearest to those of a candidate.
struct NearestLaw {
  Eigen::VectorXd parameters;
  double apart = 1;  ///< rms of the difference of their terms over that of the candidate's
};

/// Whether the terms that the effects of two fitted candidates add to the equations of `base` are the same function in these
/// episodes: they differ by no more than `share` of the first's, or of those of some of its effects alone, which `some` has. False
/// where an input is delayed.
bool SameLaw(const StateFit& base, const StateCandidate& a, const StateCandidate& b,
             std::span<const Episode> episodes, double share, const StateModel* some = nullptr);

/// Where the terms of `with`, a model with other effects than `found`, are nearest to those that the effects of `found` add to
/// the equations of `base` along its run; parameters that both have stay as found. Where the law of one holds that of the
/// other as a special case, or imitates it, this is where the fit of the other begins best. Nothing where an input is delayed.
std::optional<NearestLaw> NearestLawTo(const StateFit& base, const StateCandidate& found,
                                       const StateModel& with, std::span<const Episode> episodes,
                                       const NearestLawOptions& options = {});

}  // namespace hydroscope
