#pragma once

#include "models/machine_kind.h"

namespace hydroscope {

/// A machine whose states, outputs and effects are expressions of the machine file.
extern const MachineKind kOwnStates;

}  // namespace hydroscope
