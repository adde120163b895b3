#include "machines/flexible_axis/effects/effects.h"

namespace hydroscope::flexible_axis {

Effect LoadPositionZero() {
  Effect e;
  e.id = "load_position_zero";
  e.title = "Zero of the load's position sensor off";
  e.source = "zero of a sensor";
  e.plain = "The position sensor of the load shows a distance that is not there.";
  e.german = {"Nullpunkt des Wegsensors der Last verschoben",
              "Der Wegsensor der Last zeigt eine Strecke, die es nicht gibt."};
  e.adds = {{"load_position", "zero"}};
  e.parameters = {{.name = "zero", .start = 0.001, .min = -0.1, .max = 0.1, .unit = "m"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
