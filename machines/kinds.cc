#include "machines/die_cushion/kind.h"
#include "machines/own_balance/kind.h"
#include "machines/valve/kind.h"

namespace hydroscope {

std::span<const MachineKind* const> MachineKinds() {
  static constexpr const MachineKind* kKinds[] = {
      &kDieCushion,
      &kValve,
      &kOwnBalance,
  };
  return kKinds;
}

}  // namespace hydroscope
