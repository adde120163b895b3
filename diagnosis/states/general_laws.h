#pragma once

#include <optional>
#include <string>

#include "core/told.h"
#include "diagnosis/states/found_sets.h"

namespace hydroscope {

/// An effect of general shape that the machine file does not name.
struct GeneralLaw {
  std::string id;
  std::string equation;  ///< of this state or output
  std::string formula;   ///< in a state or input
};

/// A law of general shape (powers and a step of each state and input), in the equation that `effect` adds to, that the machine file
/// does not name and that does better in place of this only effect of the set found, both fitted: a sentence that says so. None if
/// the effect adds to several equations.
std::optional<Told> BetterGeneralLaw(const FoundSets& found, const std::string& effect);

}  // namespace hydroscope
