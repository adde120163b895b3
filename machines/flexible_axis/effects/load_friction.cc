#include "machines/flexible_axis/effects/effects.h"

namespace hydroscope::flexible_axis {

Effect LoadFriction() {
  Effect e;
  e.id = "load_friction";
  e.title = "Dry friction of the load";
  e.source = "Coulomb 1785";
  e.plain = "The guide of the load is dry, bent or dirty.";
  e.german = {"Trockene Reibung der Last", "Die Führung der Last ist trocken, verbogen oder verschmutzt."};
  e.adds = {{"v_l", "-F_l*tanh(v_l/v_dry)/m_2"}};
  e.parameters = {{.name = "F_l", .start = 20, .min = 0, .max = 2000, .unit = "N"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
