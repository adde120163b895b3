#pragma once

#include <span>
#include <vector>

#include "core/records/estimate.h"
#include "core/told.h"
#include "models/machine.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// A bulk modulus that is surely none of oil in a cylinder, though physics allows it: a model takes up any scale of the pressure, so
/// that only this tells a wrong one. A sentence; "" of other parameters and of usual ones.
Told UnusualModulus(const MachineKind& kind, const Estimate& parameter);

/// A nominal flow of a valve that none passes: a unit or the piston area is wrong, by a factor of 100, say. A sentence; "" of other
/// parameters and of flows that are.
Told ImpossibleFlow(const MachineKind& kind, const Estimate& parameter);

/// How far a parameter may be from what the data sheet of its part states (MachineParameter::stated_as).
struct StatedValueOptions {
  /// Either way. Data sheets give flows within a tenth, and an edge worn by more than a fifth wants a word as well; a reading that is
  /// twice or half of what it should be moves a flow by the root of 2 at least.
  double most_factor = 1.3;
};

/// A parameter that comes out far from what the machine file states of its part: a scale that is wrong leaves the model as good as
/// it is, and only this tells it. A sentence; "" of other parameters, and where nothing is stated.
Told UnlikeDataSheet(const Machine& machine, const Estimate& parameter,
                     const StatedValueOptions& options = {});

/// All three of all parameters that may be believed.
std::vector<Told> UnusualParameters(const Machine& machine, std::span<const Estimate> parameters);

}  // namespace hydroscope
