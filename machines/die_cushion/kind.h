#pragma once

#include "models/machine_kind.h"

namespace hydroscope {

/// A die cushion of a deep-drawing press: one cylinder with its valve to tank.
extern const MachineKind kDieCushion;
/// As it is drawn.
MachinePicture CushionPicture();

}  // namespace hydroscope
