#include <fmt/format.h>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope::flexible_axis {

Effect RetractionFriction() {
  const std::string slower = fmt::format("abs(v_p)*f*(1/{0} - 1/({0} + F_w*(v_p < 0)))", SlipForce());
  Effect e;
  e.id = "retraction_friction";
  e.title = "More friction while the rod moves in";
  e.source = "wiper of the rod gland, Bonchis, Ha and Corke 1999";
  e.plain = "The wiper at the rod gland is tight, swollen or dirty.";
  e.german = {"Mehr Reibung beim Einfahren der Stange",
              "Der Abstreifer an der Stangenführung ist eng, gequollen oder verschmutzt."};
  e.adds = {{"f", "sigma_0*" + slower},
            {"v_p", "-sigma_1*" + slower + "/m_1"},
            {"acceleration", "-sigma_1*" + slower + "/m_1"}};
  e.parameters = {{.name = "F_w", .start = 50, .min = 0, .max = 5000, .unit = "N"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
