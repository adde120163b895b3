#pragma once

#include "models/closed_loop.h"
#include "models/machine_kind.h"

namespace hydroscope {

/// A servo-hydraulic test cylinder in closed position control: a symmetric cylinder with friction and its servo valve, from
/// the valve's current to the rod's position (Li and Thurner, Accurate modeling and identification of servo-hydraulic cylinder
/// systems in multi-axial test applications, 2013).
extern const MachineKind kTestCylinder;
/// How it is measured.
extern const ClosedLoopPlant kTestCylinderPlant;
/// As it is drawn.
MachinePicture TestCylinderPicture();

}  // namespace hydroscope
