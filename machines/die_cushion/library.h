#pragma once

#include <memory>
#include <vector>

#include "models/effect.h"

namespace hydroscope {

/// Geometry the effects need.
struct CushionGeometry {
  double piston_area = 0.0;    ///< m^2
  double tank_pressure = 0.0;  ///< Pa
  double stroke = 0.2;         ///< m, working stroke, positions run 0 ... stroke
};
/// What the machine file says of it, as far as it does.
CushionGeometry CushionGeometryOf(const Machine& machine);

/// All effects of the die cushion, built for one machine, in fixed order.
std::vector<std::shared_ptr<const Effect>> DieCushionEffects(const CushionGeometry& geometry);

}  // namespace hydroscope
