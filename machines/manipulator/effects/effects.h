#pragma once

#include <memory>
#include <vector>

#include "models/effect.h"

/// The manipulator's library: one law, one file. An effect of cylinder, valve or joint stands once for each joint.
namespace hydroscope::manipulator {

/// Another mass at the tip, kg: only against rigid bodies that [geometry] knows, which would follow it otherwise.
Effect Payload();
/// Friction that is larger near standstill (Stribeck 1902).
Effect StribeckFriction(int joint);
/// An edge of the valve that wear has rounded.
Effect WornEdge(const char* edge, int joint);
/// Clearance between piston rod and link.
Effect JointPlay(int joint);

/// Those that may be told on this machine.
std::vector<std::shared_ptr<const Effect>> Effects(const Machine& machine);

}  // namespace hydroscope::manipulator
