#include "machines/pump/effects/effects.h"

namespace hydroscope::pump {

Effect StickingSpool() {
  Effect e;
  e.id = "sticking_spool";
  e.title = "Compensator spool sticks";
  e.source = "Coulomb 1785; ripple lets dry friction act gradually (dither)";
  e.plain = "Dirt or varnish at the compensator spool: clean it, look at the filter.";
  e.adds = {{"v_v", "-F_d*v_v/((abs(v_v) + v_dry)*m_v)"}};
  e.parameters = {{.name = "F_d", .start = 2, .min = 0, .max = 200, .unit = "N"}};
  return e;
}

}  // namespace hydroscope::pump
