#pragma once

#include "models/machine_kind.h"

namespace hydroscope {

/// An arm of two joints in a vertical plane, each driven by a cylinder with a four-edge valve (docs/manipulator.md).
extern const MachineKind kManipulator;
/// As it is drawn.
MachinePicture ManipulatorPicture();

}  // namespace hydroscope
