#include <fmt/format.h>

#include "machines/pump/effects/effects.h"
#include "machines/pump/equations.h"

namespace hydroscope::pump {

Effect LeakageGrown() {
  Effect e;
  e.id = "leakage_grown";
  e.title = "Leakage grown: a scored gap beside the laminar one";
  e.source = "orifice equation, Merritt 1967, 3.2";
  e.plain =
      "Oil leaves the control chamber through a score or a broken edge: look at control piston, cover seal and case drain.";
  e.german = {"Leckage gewachsen: eine Riefe neben dem laminaren Spalt",
              "Öl verlässt die Stellkammer durch eine Riefe oder eine ausgebrochene Kante: Stellkolben, "
              "Deckeldichtung und Lecköl prüfen."};
  e.adds = {{"p_c", fmt::format("-{}*C_o*p_c/sqrt(abs(p_c) + dp_lam)", ChamberStiffness())}};
  e.parameters = {{.name = "C_o", .start = 1e-8, .min = 0, .max = 1e-6, .unit = "m3/(s sqrt(Pa))"}};
  return e;
}

}  // namespace hydroscope::pump
