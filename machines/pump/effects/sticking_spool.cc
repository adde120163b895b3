#include <fmt/format.h>

#include "machines/pump/effects/effects.h"
#include "machines/pump/equations.h"

namespace hydroscope::pump {

Effect StickingSpool() {
  Effect e;
  e.id = "sticking_spool";
  e.title = "Compensator spool sticks";
  e.source =
      "Coulomb 1785; the speed that the ripple lends the spool lets dry friction act gradually (dither)";
  e.plain = "Dirt or varnish at the compensator spool: clean it, look at the filter.";
  e.german = {"Reglerschieber klemmt",
              "Schmutz oder Lackbildung am Reglerschieber: reinigen, den Filter prüfen."};
  e.shown_by = {
      "a log with the shaft at two fifths of its speed, to be explained alone: the ripple comes slower then",
      "die Welle bei zwei Fünfteln ihrer Drehzahl, für sich zu erklären: die Pulsation kommt dann langsamer"};
  e.adds = {{"v_v", fmt::format("-{}/m_v", DryFriction("F_d", "v_v", "v_d"))}};
  e.parameters = {{.name = "F_d", .start = 2, .min = 0, .max = 50, .unit = "N"},
                  {.name = "v_d", .start = 1e-2, .min = 2e-3, .max = 1e-1, .unit = "m/s"}};
  return e;
}

}  // namespace hydroscope::pump
