#pragma once

#include "models/effect.h"

namespace hydroscope {

/// The effects that a model with states may be missing: those of its kind whose outputs are measured, then those of the
/// machine file.
std::vector<Effect> StateEffectsOf(const Machine& machine);

/// The one of this id; nullptr if there is none.
const Effect* FindStateEffect(const std::vector<Effect>& effects, const std::string& id);

/// An [[effect]] of a machine file with states, for the library.
Effect DescribeStateEffect(const Machine& machine, const UserEffectSpec& spec);

}  // namespace hydroscope
