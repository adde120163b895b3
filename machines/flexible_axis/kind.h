#pragma once

#include "models/machine_kind.h"

namespace hydroscope {

/// `model = "flexible_axis"`: valve, cylinder, and a mass that carries a second one on a spring and
/// a damper (docs/flexible_axis.md).
extern const MachineKind kFlexibleAxis;
/// As it is drawn.
MachinePicture FlexibleAxisPicture();

}  // namespace hydroscope
