#include <fmt/format.h>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope::flexible_axis {

Effect FreeAir() {
  Effect e;
  e.id = "free_air";
  e.title = "Air in the oil";
  e.source = "compliance of oil and isothermal air in series, Merritt 1967, 2.5";
  e.plain = "Bleed the cylinder; look for foam in the tank and for a leak on the suction side.";
  e.german = {"Luft im Öl",
              "Den Zylinder entlüften; nach Schaum im Tank und einer Undichtigkeit der Saugseite suchen."};
  e.adds = {{"p_1", fmt::format("{0}*(1/(1 + {1}*air*p_atm/(max(p_1, 0) + p_atm)^2) - 1)", PressureRate(1),
                                BulkModulus("p_1"))},
            {"p_2", fmt::format("{0}*(1/(1 + {1}*air*p_atm/(max(p_2, 0) + p_atm)^2) - 1)", PressureRate(2),
                                BulkModulus("p_2"))}};
  e.parameters = {{.name = "air", .start = 0.005, .min = 0, .max = 0.2, .unit = "1"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
