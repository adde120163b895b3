#include <fmt/format.h>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope::flexible_axis {

Effect SpoolOverlap() {
  const char* const spool = "sign(x_s)*max(abs(x_s) - overlap, 0)";
  Effect e;
  e.id = "spool_overlap";
  e.title = "Overlap of the spool";
  e.source = "valve opening over spool position, Merritt 1967, 5.2";
  e.plain = "Small commands give no flow: a valve with overlap, or dirt that keeps it closed.";
  e.german = {"Überdeckung des Schiebers",
              "Kleine Signale geben keinen Durchfluss: ein Ventil mit Überdeckung, "
              "oder Schmutz hält es geschlossen."};
  e.adds = {{"p_1", fmt::format("{}*({} - {})", Stiffness(1), Flow(1, spool), Flow(1, "x_s"))},
            {"p_2", fmt::format("{}*({} - {})", Stiffness(2), Flow(2, spool), Flow(2, "x_s"))}};
  e.parameters = {{.name = "overlap", .start = 0.05, .min = 0, .max = 2, .unit = "V"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
