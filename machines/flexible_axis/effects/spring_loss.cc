#include "machines/flexible_axis/effects/effects.h"

namespace hydroscope::flexible_axis {

Effect SpringLoss() {
  Effect e;
  e.id = "spring_loss";
  e.title = "Spring between piston and load softer";
  e.source = "Hooke";
  e.plain = "The spring or its mount is softer than stated: cracked, loose, or exchanged.";
  e.german = {"Feder zwischen Kolben und Last weicher",
              "Die Feder oder ihre Befestigung ist weicher als angegeben: gerissen, lose oder ausgetauscht."};
  e.adds = {{"v_p", "share*k*(x_p - x_l)/m_1"},
            {"v_l", "-share*k*(x_p - x_l)/m_2"},
            {"acceleration", "share*k*(x_p - x_l)/m_1"}};
  e.parameters = {{.name = "share", .start = 0.05, .min = -0.5, .max = 0.9, .unit = "1"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
