#pragma once

#include "models/machine_kind.h"

namespace hydroscope {

/// A machine whose balance and effects are expressions of the machine file.
extern const MachineKind kOwnBalance;

}  // namespace hydroscope
