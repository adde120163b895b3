#pragma once

#include <string>

#include "core/told.h"

namespace hydroscope {

/// What a stroke was driven at, as far as its machine cares: stored with the stroke. Strokes that differ much in one are
/// of another kind (drift watch), strokes that are all alike in one hide what only its change would show.
struct Condition {
  enum class Of {
    kMean,
    kLargest,   ///< of block means
    kMeanRate,  ///< mean magnitude of d/dt
  };

  std::string name;    ///< in tables and JSON: "speed"
  Told title;          ///< "mean speed"
  std::string signal;  ///< of the machine
  Of of = Of::kMean;
  std::string unit;                ///< SI
  double least = 0;                ///< SI, magnitude below which values count as the same
  double lowest = 0, highest = 0;  ///< SI, beyond them no such machine works; equal: not known
  Told vary = {};   ///< what to vary so that it changes, "ram speed"; "": nobody sets it by itself
  Told hides = {};  ///< what nobody sees where it stays the same; "": nothing known

  bool operator==(const Condition&) const = default;
};

}  // namespace hydroscope
