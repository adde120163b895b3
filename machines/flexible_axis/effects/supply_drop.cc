#include <fmt/format.h>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope::flexible_axis {

Effect SupplyDrop() {
  Effect e;
  e.id = "supply_drop";
  e.title = "Supply pressure lower than stated";
  e.source = "orifice equation, Merritt 1967, 3.2";
  e.plain =
      "Look at the pump, its relief valve and the accumulator: the valve gets less pressure than the machine file says.";
  e.german = {
      "Versorgungsdruck kleiner als angegeben",
      "Pumpe, ihr Druckbegrenzungsventil und Speicher prüfen: das Ventil erhält weniger Druck, als die "
      "Maschinendatei sagt."};
  e.adds = {{"p_1", fmt::format("{}*Q_n/U_n*max(x_s, 0)*({} - {})", Stiffness(1), Root("p_s - drop - p_1"),
                                Root("p_s - p_1"))},
            {"p_2", fmt::format("{}*Q_n/U_n*max(-x_s, 0)*({} - {})", Stiffness(2), Root("p_s - drop - p_2"),
                                Root("p_s - p_2"))}};
  e.parameters = {{.name = "drop", .start = 1e6, .min = 0, .max = 8e6, .unit = "Pa"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
