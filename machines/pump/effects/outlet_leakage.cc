#include <fmt/format.h>

#include "machines/pump/effects/effects.h"
#include "machines/pump/equations.h"

namespace hydroscope::pump {

Effect OutletLeakage() {
  Effect e;
  e.id = "outlet_leakage";
  e.title = "Leak to the outside";
  e.source = "laminar gap, Merritt 1967, 3.3";
  e.plain = "Oil is lost between pump and flow sensor: look under the machine.";
  e.german = {"Leckage nach außen",
              "Zwischen Pumpe und Durchflusssensor geht Öl verloren: unter der Maschine nachsehen."};
  e.adds = {{"p", fmt::format("-{}*C_e*{}", LineStiffness(), OutletPressure())}};
  e.parameters = {{.name = "C_e", .start = 1e-12, .min = 0, .max = 1e-10, .unit = "m3/(s Pa)"}};
  return e;
}

}  // namespace hydroscope::pump
