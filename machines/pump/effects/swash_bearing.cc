#include <fmt/format.h>

#include "machines/pump/effects/effects.h"
#include "machines/pump/equations.h"

namespace hydroscope::pump {

Effect SwashBearing() {
  Effect e;
  e.id = "swash_bearing";
  e.title = "Swash bearing worn";
  e.source = "Coulomb 1785";
  e.plain = "Dry friction of the swash plate: its bearing is worn or dry; the pressure hunts.";
  e.german = {
      "Lager der Schrägscheibe verschlissen",
      "Trockene Reibung der Schrägscheibe: ihr Lager ist verschlissen oder trocken; der Druck pendelt."};
  e.adds = {{"v_p", fmt::format("-{}/m_p", DryFriction("F_b", "v_p", "v_b"))}};
  e.parameters = {{.name = "F_b", .start = 30, .min = 0, .max = 5000, .unit = "N"},
                  {.name = "v_b", .start = 1e-2, .min = 1e-3, .max = 5e-2, .unit = "m/s"}};
  return e;
}

}  // namespace hydroscope::pump
