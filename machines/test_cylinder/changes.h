#pragma once

#include <span>

#include "models/closed_loop.h"

namespace hydroscope {

/// What may happen to a test cylinder between two records, as changes of its parameters.
std::span<const LoopChange> TestCylinderChanges();

/// A valve or an amplifier that gives out no more than some current.
inline constexpr LoopChange kValveSaturation = {
    "valve_saturation",
    {"current that the valve follows", "Strom, dem das Ventil folgt"},
    {"the amplifier or the valve is at its end: excite less, or look at its supply",
     "Verstärker oder Ventil sind am Anschlag: weniger anregen, oder die Versorgung ansehen"},
    {}};

}  // namespace hydroscope
