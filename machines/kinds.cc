#include "machines/die_cushion/kind.h"
#include "machines/flexible_axis/kind.h"
#include "machines/manipulator/kind.h"
#include "machines/own_balance/kind.h"
#include "machines/own_states/kind.h"
#include "machines/pump/kind.h"
#include "machines/test_cylinder/kind.h"
#include "machines/valve/kind.h"

namespace hydroscope {

std::span<const MachineKind* const> MachineKinds() {
  static constexpr const MachineKind* kKinds[] = {
      &kDieCushion, &kValve, &kOwnBalance, &kOwnStates, &kTestCylinder, &kManipulator, &kFlexibleAxis, &kPump,
  };
  return kKinds;
}

}  // namespace hydroscope
