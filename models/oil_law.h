#pragma once

namespace hydroscope {

/// How a parameter depends on the oil, for its reference over the oil temperature.
enum class OilLaw {
  kNone,       ///< a volume, a position: at one speed of the machine it could not be told from what does
  kViscosity,  ///< with the viscosity: flow through narrow edges
  kSmooth,     ///< anyhow, but smoothly
};

}  // namespace hydroscope
