#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "diagnosis/explain.h"

namespace hydroscope {

/// One step of a parameter of the base model that explains as much as an even drift of it.
struct StepInPlace {
  std::string parameter;
  std::size_t stroke = 0;  ///< the first with the new value
};

/// The step of what `drift` says is drifting, in the place of number `at` of `found.chosen` and beside the other effects chosen, where
/// one leaves less of the error than what was chosen does (a change point at the place that suits it best, Quandt 1960). Nothing if
/// none does, or if what drifts is no parameter of the base model.
std::optional<StepInPlace> StepInPlaceOf(const StrokeSet& strokes, const Explanation& found, std::size_t at,
                                         const Effect& drift);

}  // namespace hydroscope
