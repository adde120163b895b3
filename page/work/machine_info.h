#pragma once

#include <nlohmann/json_fwd.hpp>

#include "models/machine.h"

namespace hydroscope {

/// The machine as it is drawn (models/machine_picture.h): `width`, `height`, `drawing` (SVG elements) and `places` of its
/// signals (`signal`, `x`, `y`, `to_x`, `to_y`, `meaning`, `german`).
nlohmann::json PictureJson(const Machine& machine);
/// What the page has to know of a machine beside its model: what it is and counts, its words, its picture.
nlohmann::json MachineInfoJson(const Machine& machine);

}  // namespace hydroscope
