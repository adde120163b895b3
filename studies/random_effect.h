#pragma once

#include <random>
#include <string>

#include "diagnosis/extended_fit.h"
#include "simulator/die_cushion/press_options.h"

namespace hydroscope {

/// Uniform double in [0, 1) that does not depend on the library's distributions.
double Uniform(std::mt19937_64& random);

/// An effect of the simulator, its size between `min_factor` and `max_factor` times the typical one
/// (log-uniform), thresholds and places at random. `visible`: none that drawing strokes leave no trace of.
EffectSetting RandomEffect(std::mt19937_64& random, double min_factor, double max_factor, bool visible);

/// The same of the effect `id`, which the simulator must know.
EffectSetting RandomSize(std::mt19937_64& random, const std::string& id, double min_factor,
                         double max_factor);

/// Held-out error of a model over its noise floor, less 1.
double ErrorOverFloor(const ExtendedFit& fit);

/// Relative rise of the error below which an effect counts as too weak, and from which on as strong.
inline constexpr double kNoticedError = 0.02, kStrongError = 0.10;

}  // namespace hydroscope
