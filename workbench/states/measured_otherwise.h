#pragma once

#include <optional>
#include <span>

#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/other_causes/missing_zero.h"
#include "diagnosis/states/other_causes/sampling.h"
#include "estimation/states/fit.h"
#include "pipeline/episodes.h"

namespace hydroscope {

/// How a log seems to have been measured where that is otherwise than the machine file says, which looks like a missing law.
struct MeasuredOtherwise {
  std::optional<OtherSampling> sampling;
  std::optional<MissingZeros> zeros;
};

/// Asked of a fit. Where that seems to leave noise no zeros are looked for.
MeasuredOtherwise FindMeasuredOtherwise(const StateFit& fit, std::span<const Episode> episodes,
                                        LeftBySampling left);

/// Asked of what was found; `fitted`: the episodes or short runs that it was found on.
MeasuredOtherwise FindMeasuredOtherwise(const StatesExplanation& found, std::span<const Episode> fitted);

enum class TakenOtherwise { kNothing, kSampling, kZeros };

/// Writes the one that leaves less into the machine of the log, with a warning. Nothing, where a machine file states its sampling
/// and there is no other.
TakenOtherwise TakeOtherwise(const MeasuredOtherwise& otherwise, EpisodeLog& log);

}  // namespace hydroscope
