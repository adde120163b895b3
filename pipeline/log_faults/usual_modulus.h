#pragma once

#include <span>
#include <vector>

#include "core/records/estimate.h"
#include "core/told.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// A bulk modulus that is surely none of oil in a cylinder, though physics allows it: a model takes up any scale of the pressure, so
/// that only this tells a wrong one. A sentence; "" of other parameters and of usual ones.
Told UnusualModulus(const MachineKind& kind, const Estimate& parameter);

/// A nominal flow of a valve that none passes: a unit or the piston area is wrong, by a factor of 100, say. A sentence; "" of other
/// parameters and of flows that are.
Told ImpossibleFlow(const MachineKind& kind, const Estimate& parameter);

/// Both of all parameters that may be believed.
std::vector<Told> UnusualParameters(const MachineKind& kind, std::span<const Estimate> parameters);

}  // namespace hydroscope
