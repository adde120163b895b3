#pragma once

#include <span>
#include <string>
#include <vector>

#include "diagnosis/explain.h"

namespace hydroscope {

/// Effects of an explanation that rest on the shape of another one. Stored Grams hold a law with a threshold,
/// a place or a delay at a few values only, and what lies between them is a straight line between two; the
/// true law leaves what neither of them is, and a second law picks that up. So each effect found must still
/// gain ExplainOptions::min_gain, and stand out by second_t standard errors, once every other effect of the
/// model may be any mixture of its stored shapes; and no other one that was found may contradict the shape it
/// was fitted at (Effect::implied). Returns those that fail, of two that rest on one another the one with
/// less evidence.
std::vector<std::string> EffectsOfShapes(const StrokeSet& strokes, const Explanation& explanation,
                                         const ExplainOptions& options);

/// WidenByNonlinear from stored sums alone: in a fit that also has the nearest other stored shape of an effect the sum of the two
/// sizes is the size, and the shape is free. Makes no interval narrower; leaves `fit` (of base + `choices`) as it is where the
/// strokes do not determine the wider one, and beside laws that tie their shape to their size (Effect::implied).
void WidenByStoredShapes(const StrokeSet& strokes, std::span<const EffectChoice> choices, ExtendedFit& fit);

}  // namespace hydroscope
