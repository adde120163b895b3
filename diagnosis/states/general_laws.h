#pragma once

#include <span>
#include <string>
#include <vector>

#include "estimation/states/fit.h"

namespace hydroscope {

/// An effect of general shape that the machine file does not name.
struct GeneralLaw {
  std::string id;
  std::string equation;  ///< of this state or output
  std::string formula;   ///< in a state or input
};

/// A machine with effects of general shape (powers and a step of each state and input) in the equation that one of its effects
/// adds to. None where it adds to several.
struct GeneralLaws {
  Machine machine;
  std::vector<GeneralLaw> laws;

  /// `rest`: the machine fitted without the effect.
  GeneralLaws(const Machine& without, const std::string& effect, const StateFit& rest,
              std::span<const Episode> episodes);
};

}  // namespace hydroscope
