#pragma once

#include <span>

#include "core/told.h"
#include "diagnosis/extended_fit.h"

namespace hydroscope {

/// Why the noise that `fit` of all strokes counts with is not believable: alone it would leave more than `most` times as much as base
/// + `start` leaves on one half of the strokes, fitted by itself. A log of two machines, or of one that was changed, bends a fit
/// until noise alone would leave as much as it does. "" if nothing speaks against it, or strokes are too few.
Told WhyNoiseIsNotBelievable(const StrokeSet& strokes, std::span<const EffectChoice> start,
                             const ExtendedFit& fit, double most);

}  // namespace hydroscope
