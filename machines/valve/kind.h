#pragma once

#include "models/machine_kind.h"

namespace hydroscope {

/// A servo valve: command and response, measured by its frequency response.
extern const MachineKind kValve;

}  // namespace hydroscope
