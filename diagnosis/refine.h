#pragma once

#include <memory>
#include <span>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// The gated samples of one stroke, as the pipeline cut them.
using StrokeStretches = std::vector<Stretch>;

/// Grams of kept samples under any model over the same channels.
std::vector<StrokeGram> GramsOf(std::shared_ptr<const ModelStructure> model,
                                std::span<const StrokeStretches> strokes, const WindowSamples& window);

/// Finds the nonlinear parameters (threshold, width, exponent, ...) of effect `start.effect`, in a model that
/// also has the effects `others`, from the best shape `start`: those a law ties to its size (Effect::implied)
/// by going back and forth between the two, free ones by the error on strokes left out, coordinate by
/// coordinate with Brent's method within the admissible range. Returns their values, or `start`'s own if the
/// effect has none.
std::vector<double> RefineNonlinear(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                                    const WindowSamples& window, std::span<const EffectChoice> others,
                                    const EffectChoice& start);

/// Shapes of all of `choices` at once whose law ties them to their size: each takes the value that the common
/// fit implies, again and again until they stay. Returns the nonlinear parameters of every choice; those of
/// free ones are unchanged.
std::vector<std::vector<double>> RefineTogether(const ModelStructure& model,
                                                std::span<const StrokeStretches> strokes,
                                                const WindowSamples& window,
                                                std::span<const EffectChoice> choices);

}  // namespace hydroscope
