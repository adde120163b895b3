#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope::flexible_axis {

Effect LoadMass() {
  Effect e;
  e.id = "load_mass";
  e.title = "Mass of the load other than stated";
  e.source = "Newton";
  e.plain = "Something was put onto the load, or taken off it.";
  e.german = {"Masse der Last anders als angegeben",
              "Auf die Last wurde etwas gelegt oder von ihr genommen."};
  e.adds = {{"v_l", SpringForce() + "*(1/(m_2 + more) - 1/m_2)"}};
  e.parameters = {{.name = "more", .start = 5, .min = -40, .max = 400, .unit = "kg"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
