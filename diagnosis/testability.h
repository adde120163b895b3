#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "diagnosis/extended_fit.h"
#include "models/stretch.h"

namespace hydroscope {

/// Why an effect cannot be tested if the means over strokes of the signal that its law lives on, SI, span
/// less than Effect::least_span; "" if they span enough or the law asks for none.
Told WhyUntestable(const Effect& effect, std::span<const double> stroke_means);

/// Adds to `untestable` the effects of the model's library, with those that need samples, that WhyUntestable
/// objects to, by id.
void AddUntestable(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                   std::map<std::string, Told>& untestable);

/// Square of the correlation of the means over strokes of a channel with time, 0 if it
/// was not measured (-1) or did not move.
double SharedCourse(std::span<const StrokeStretches> strokes, int channel);

}  // namespace hydroscope
