#include "machines/pump/effects/effects.h"

namespace hydroscope::pump {

Effect SwashBearing() {
  Effect e;
  e.id = "swash_bearing";
  e.title = "Swash bearing worn";
  e.source = "Coulomb 1785";
  e.plain = "Dry friction of the swash plate: its bearing is worn or dry; the pressure hunts.";
  e.adds = {{"v_p", "-F_b*v_p/((abs(v_p) + v_dry)*m_p)"}};
  e.parameters = {{.name = "F_b", .start = 30, .min = 0, .max = 5000, .unit = "N"}};
  return e;
}

}  // namespace hydroscope::pump
