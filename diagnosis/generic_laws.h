#pragma once

#include "models/effect.h"

namespace hydroscope {

/// Adds laws without a name to a die-cushion model: the first powers and products of its signals, as a flow,
/// a flow gain or a volume. They never become a verdict. They tell whether a named effect has left something,
/// and whether a law that nobody thought of would do as well. Models over other channels stay as they are.
void AddGenericLaws(ModelStructure& model);

bool IsGeneric(const Effect& effect);
/// Whether the law of that id is a flow that goes with a signal, like a leak.
bool IsPlainFlow(const std::string& id);

}  // namespace hydroscope
