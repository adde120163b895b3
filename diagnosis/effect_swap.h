#pragma once

#include <functional>
#include <optional>
#include <string>

#include "diagnosis/explain.h"

namespace hydroscope {

/// Whether one of the effects that the model has already may be wrong: something is left that is not
/// explained for certain, or one of them is no longer seen.
bool MayHoldWrongEffect(const Explanation& as_it_is);

/// What comes of taking effect `id` out: `without` explains the model that has the others only. A swap if
/// that does better on strokes left out than the model as it is (stroke by stroke, by 2.5 standard errors)
/// and no worse than what explaining on top of it reached, or as well with fewer effects; nullopt if `id` is
/// wanted back.
std::optional<EffectSwap> SwapFor(const std::string& id, const Explanation& as_it_is,
                                  const Explanation& without);

/// The best swap of an effect of ExplainOptions::start; `without` explains the strokes of `as_it_is` by the others alone.
std::optional<EffectSwap> BestSwap(const ExplainOptions& options, const Explanation& as_it_is,
                                   const std::function<Explanation(const std::string&)>& without);

}  // namespace hydroscope
