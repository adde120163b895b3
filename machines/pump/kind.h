#pragma once

#include "models/machine_kind.h"

namespace hydroscope {

/// `model = "pump"`: pressure-compensated pump of variable displacement (docs/pump.md).
extern const MachineKind kPump;
/// As it is drawn.
MachinePicture PumpPicture();

}  // namespace hydroscope
