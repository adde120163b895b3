#pragma once

#include <span>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

struct EffectStartsOptions {
  int draws = 24;    ///< of the effect's parameters from their ranges, beside those of the machine file
  int kept = 2;      ///< best of them
  int unranked = 4;  ///< draws of an effect that delays an input, which cannot be ranked
  std::uint32_t seed = 1;
};

/// Starts for a fit of `with`, which is the model of `near` with further effects: parameters known from `near` stay, those of
/// the effects are drawn from their ranges. Which draws are worth a fit is asked of the tangent of `near` (a score test, Rao
/// 1948): each draw's effect enters its equations as a term of size zero, and the share of the error that its sensitivity
/// explains, with parameters and initial states free, ranks the draw. A parameter that the effect is proportional to is set
/// to what the regression gives, inside its range. Best first, last the machine file's own values.
std::vector<StateStart> EffectStarts(const StateFit& near, std::shared_ptr<const StateModel> with,
                                     std::span<const Episode> episodes,
                                     const EffectStartsOptions& options = {});

}  // namespace hydroscope
