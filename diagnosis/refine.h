#pragma once

#include <memory>
#include <span>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// Finds the nonlinear parameters (threshold, width, exponent, ...) of effect `start.effect`, in a model that
/// also has the effects `others`, from the best shape `start`: those a law ties to its size (Effect::implied)
/// by going back and forth between the two, free ones by the error on strokes left out, coordinate by
/// coordinate with Brent's method within the admissible range. Adds the shape to the model, unless it is
/// there, and returns it. Effects without a grid (diagnosis/remainder/tone_search.h) stay as they are.
EffectChoice RefineOne(ModelStructure& model, std::span<const StrokeStretches> strokes,
                       const WindowSamples& window, std::span<const EffectChoice> others,
                       const EffectChoice& start);

/// Adds the shape at which the last effect of `fit`, whose law ties it to its size, agrees with the size found there. False if
/// it agrees already, or no law ties it.
bool AddImpliedShape(ModelStructure& model, const ExtendedFit& fit);

/// The same for all effects of a model. Those tied to their size take the values that the common fit implies,
/// again and again until they stay, then free ones are found given the others; each on the signals as the
/// others correct them (Effect::correct). Returns the shapes, in the order of `choices`.
std::vector<EffectChoice> RefineModel(ModelStructure& model, std::span<const StrokeStretches> strokes,
                                      const WindowSamples& window, std::vector<EffectChoice> choices);

}  // namespace hydroscope
