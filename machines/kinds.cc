#include <utility>

#include "machines/die_cushion/kind.h"
#include "machines/flexible_axis/kind.h"
#include "machines/manipulator/kind.h"
#include "machines/own_balance/kind.h"
#include "machines/own_states/kind.h"
#include "machines/test_cylinder/kind.h"
#include "machines/valve/kind.h"

namespace hydroscope {

std::span<const MachineKind* const> MachineKinds() {
  static constexpr const MachineKind* kKinds[] = {
      &kDieCushion, &kValve, &kOwnBalance, &kOwnStates, &kTestCylinder, &kManipulator, &kFlexibleAxis,
  };
  return kKinds;
}

const ClosedLoopPlant* ClosedLoopOf(const Machine& machine) {
  static constexpr std::pair<const MachineKind*, const ClosedLoopPlant*> kPlants[] = {
      {&kTestCylinder, &kTestCylinderPlant},
  };
  for (const auto& [kind, plant] : kPlants)
    if (&KindOf(machine) == kind) return plant;
  return nullptr;
}

}  // namespace hydroscope
