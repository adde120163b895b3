#pragma once

#include <array>
#include <vector>

#include "models/states_spec.h"

namespace hydroscope::manipulator {

/// Control edges of a valve in the order of the paper's table II: P supply, T tank, A piston side, B rod side.
inline constexpr std::array<const char*, 4> kEdges = {"PA", "AT", "PB", "BT"};

/// Base parameters of the rigid bodies: moments about the joints, kg m, and inertias, kg m2, with what link 2 adds to link 1
/// (mx_1 = m_1 c_x1 + m_2 a_1, J_1 = I_1 + m_2 a_1^2).
inline constexpr std::array<const char*, 6> kRigid = {"mx_1", "my_1", "J_1", "mx_2", "my_2", "J_2"};

/// What can be identified, with the ranges of arms from a loader's to a forest crane's; starts are those of the paper's
/// datasheets and CAD (table I, and 6.3e-7 m3/(s sqrt(Pa)) for all edges).
std::vector<ParameterSpec> ParameterRanges();

}  // namespace hydroscope::manipulator
