#include "machines/flexible_axis/effects/effects.h"

namespace hydroscope::flexible_axis {

Effect PressureZero() {
  Effect e;
  e.id = "pressure_1_zero";
  e.title = "Zero of the piston-side pressure sensor off";
  e.source = "zero of a sensor";
  e.plain = "Read the sensor with the chamber open to tank.";
  e.german = {"Nullpunkt des kolbenseitigen Drucksensors verschoben",
              "Den Sensor bei zum Tank offener Kammer ablesen."};
  e.adds = {{"pressure_1", "zero"}};
  e.parameters = {{.name = "zero", .start = 1e5, .min = -2e6, .max = 2e6, .unit = "Pa"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
