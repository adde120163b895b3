#include "estimation/closed_loop/reversal.h"

#include <cmath>

namespace hydroscope {

Told ReversedSignal(const ClosedLoopPlant& plant, const std::vector<double>& parameters,
                    const std::vector<double>& known) {
  for (std::size_t i = 0; i < plant.parameters.size(); ++i) {
    if (plant.parameters[i].kind != LoopParameter::Kind::kGain) continue;
    const bool is_known = !known.empty() && std::isfinite(known[i]) && known[i] != 0;
    if (!(parameters[i] * (is_known ? known[i] : 1) < 0)) continue;
    return Tell(
        "{} or {} is reversed: {} has the other sign than {}; check the wiring, or set scale = -1 for the one that is in [signals] "
        "of the machine file",
        "{} oder {} ist umgekehrt: {} hat das andere Vorzeichen als {}; die Verdrahtung prüfen, oder für das Verkehrte in [signals] "
        "der Maschinendatei scale = -1 setzen",
        plant.output, plant.input, plant.parameters[i].name,
        is_known ? Wording{"that of the machine file", "das der Maschinendatei"}
                 : Wording{"such a plant has", "bei solchen Strecken"});
  }
  return {};
}

}  // namespace hydroscope
