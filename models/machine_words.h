#pragma once

#include <string>

namespace hydroscope {

/// What sentences and plots call the things of a machine.
struct MachineWords {
  std::string output;      ///< what is measured and modelled: "flow"
  std::string stroke;      ///< what the gate lets through: "drawing stroke"
  std::string vary;        ///< what to vary so that parameters can be told apart: "ram speed and pressure"
  std::string sign;        ///< what the sign of measured minus modelled tells, "" if nothing is known of it
  bool hydraulic = false;  ///< pressures, strokes and temperatures are as hydraulic machines have them
};

}  // namespace hydroscope
