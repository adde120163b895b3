#pragma once

#include <optional>
#include <string>

#include "core/told.h"
#include "diagnosis/extended_fit.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// A physical parameter of the base model that another fit of the same strokes gives another value.
struct MovedParameter {
  std::string name;
  double share = 0;              ///< change over the value, 1: 100 %
  bool leaves_interval = false;  ///< the other value is outside its 95 % interval
  double change = 0;             ///< SI
  std::string unit = {};         ///< SI
};

/// The first parameter that moves from `as_is` to `with` by more than `least` of what is useful to know of it
/// (DerivedParameter::useful_std), one that leaves its interval before others; nullopt if none does. A parameter near zero, which
/// has no percentages (core/relative_change.h), does not count.
std::optional<MovedParameter> FindMovedParameter(const ModelStructure& model, const ExtendedFit& as_is,
                                                 const ExtendedFit& with, double least);

/// "+12 %"; "+0.4 % of stroke" of a parameter whose zero is one of many (ToldInPercent).
Told ChangeTold(const MachineKind& kind, const MovedParameter& moved);

}  // namespace hydroscope
