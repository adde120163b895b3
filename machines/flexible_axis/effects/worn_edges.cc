#include <fmt/format.h>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope::flexible_axis {

Effect WornEdges() {
  Effect e;
  e.id = "worn_edges";
  e.title = "Metering edges worn";
  e.source = "leakage of an open-centre valve, Merritt 1967, 5.3";
  e.plain =
      "Oil flows through both edges while the spool is closed: the edges are worn; pressures wander at rest.";
  e.german = {"Steuerkanten verschlissen",
              "Bei geschlossenem Schieber fließt Öl durch beide Kanten: sie sind verschlissen; die Drücke "
              "wandern im Stillstand."};
  e.adds = {{"p_1",
             fmt::format("{}*Q_n/U_n*opening*({} - {})", Stiffness(1), Root("p_s - p_1"), Root("p_1 - p_t"))},
            {"p_2", fmt::format("{}*Q_n/U_n*opening*({} - {})", Stiffness(2), Root("p_s - p_2"),
                                Root("p_2 - p_t"))}};
  e.parameters = {{.name = "opening", .start = 0.02, .min = 0, .max = 1, .unit = "V"}};
  return e;
}

}  // namespace hydroscope::flexible_axis
