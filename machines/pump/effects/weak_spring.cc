#include "machines/pump/effects/effects.h"

namespace hydroscope::pump {

Effect WeakSpring() {
  Effect e;
  e.id = "weak_spring";
  e.title = "Compensator spring weak beyond a deflection";
  e.source = "Hooke; a cracked coil gives way once it opens";
  e.plain =
      "A coil of the compensator spring is cracked: the pressure rises less than it should as the flow falls.";
  e.german = {
      "Feder des Reglers ab einer Auslenkung zu schwach",
      "Eine Windung der Reglerfeder ist gebrochen: der Druck steigt bei fallendem Durchfluss weniger, als er soll."};
  e.adds = {{"v_v", "share*K_v*max(x_v - x_k, 0)/m_v"}};
  e.parameters = {{.name = "share", .start = 0.1, .min = 0, .max = 0.9, .unit = "1"},
                  {.name = "x_k", .start = 1e-4, .min = 2e-5, .max = 4e-4, .unit = "m"}};
  return e;
}

}  // namespace hydroscope::pump
