#include "machines/flexible_axis/effects/effects.h"

namespace hydroscope::flexible_axis {

Effect AccelerationZero() {
  Effect e;
  e.id = "acceleration_zero";
  e.title = "Zero of the acceleration sensor off";
  e.source = "zero of a sensor";
  e.plain = "The sensor shows an acceleration at rest: mounted at a slant, or drifted.";
  e.german = {"Nullpunkt des Beschleunigungssensors verschoben",
              "Der Sensor zeigt im Stillstand eine Beschleunigung: schief montiert oder gedriftet."};
  e.adds = {{"acceleration", "zero"}};
  e.parameters = {{.name = "zero", .start = 0.05, .min = -5, .max = 5, .unit = "m/s2"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
