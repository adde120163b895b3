#pragma once

#include "core/told.h"

namespace hydroscope {

/// What sentences and plots call the things of a machine.
struct MachineWords {
  Told output;             ///< what is measured and modelled: "flow"
  Told stroke;             ///< what the gate lets through: "drawing stroke"
  Told vary;               ///< what to vary so that parameters can be told apart: "ram speed and pressure"
  Told sign = {};          ///< what the sign of measured minus modelled tells, "" if nothing is known of it
  bool hydraulic = false;  ///< pressures, strokes and temperatures are as hydraulic machines have them
};

}  // namespace hydroscope
