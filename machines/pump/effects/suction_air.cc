#include <fmt/format.h>

#include "machines/pump/effects/effects.h"
#include "machines/pump/equations.h"

namespace hydroscope::pump {

Effect SuctionAir() {
  Effect e;
  e.id = "suction_air";
  e.title = "Air in the suction line";
  e.source = "filling of the pistons, Ivantysyn and Ivantysynova 2001";
  e.plain =
      "Each stroke is filled with some air: look at the suction line, its shaft seal, the oil level and foam.";
  e.german = {
      "Luft in der Saugleitung",
      "Jeder Hub füllt sich zum Teil mit Luft: Saugleitung, Wellendichtung, Ölstand und Schaum prüfen."};
  e.adds = {{"p", fmt::format("-air*{}*{}", LineStiffness(), Delivered())}};
  e.parameters = {{.name = "air", .start = 0.01, .min = 0, .max = 0.5, .unit = "1"}};
  return e;
}

}  // namespace hydroscope::pump
