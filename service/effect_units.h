#pragma once

#include <string>
#include <string_view>

#include "core/units.h"
#include "models/model_structure.h"

namespace hydroscope {

/// A unit as people read it for the size of an effect: "m3/(s Pa)" -> "l/min per bar".
struct EffectUnit {
  double factor = 1.0;  ///< shown = SI * factor
  std::string name;     ///< "-" for numbers without unit
};
EffectUnit EffectUnitFor(std::string_view si);

/// The unit in which people read the output of a model and its errors: l/min for the flows of a die cushion (and if
/// there is no model), N for a force balance.
DisplayUnit OutputUnit(const ModelStructure* model);
/// The same of the model that a machine file describes.
DisplayUnit OutputUnit(const Machine& machine);

}  // namespace hydroscope
