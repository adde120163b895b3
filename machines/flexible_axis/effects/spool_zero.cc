#include <fmt/format.h>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope::flexible_axis {

Effect SpoolZero() {
  const char* const spool = "x_s - x_0";
  Effect e;
  e.id = "spool_zero";
  e.title = "Zero of the spool off";
  e.source = "valve opening over spool position, Merritt 1967, 5.2";
  e.plain = "The valve is closed at another command than 0 V: adjust its null or check the torque motor.";
  e.german = {"Nullpunkt des Schiebers verschoben",
              "Das Ventil ist bei einem anderen Signal als 0 V geschlossen: Nullpunkt einstellen oder den "
              "Torquemotor prüfen."};
  e.adds = {{"p_1", fmt::format("{}*({} - {})", Stiffness(1), Flow(1, spool), Flow(1, "x_s"))},
            {"p_2", fmt::format("{}*({} - {})", Stiffness(2), Flow(2, spool), Flow(2, "x_s"))}};
  e.parameters = {{.name = "x_0", .start = 0.01, .min = -2, .max = 2, .unit = "V"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
