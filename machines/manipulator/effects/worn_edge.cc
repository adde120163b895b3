#include <fmt/format.h>

#include "machines/manipulator/effects/effects.h"
#include "machines/manipulator/equations.h"

namespace hydroscope::manipulator {

/// The edge opens by (y + sqrt(y^2 + r^2))/2 in place of max(y, 0): it leaks about the null.
Effect WornEdge(const char* edge, int joint) {
  Effect e;
  e.id = fmt::format("worn_edge_{}_{}", edge, joint);
  e.title = fmt::format("Edge {} of valve {} is worn", edge, joint);
  e.law = "opening (y + sqrt(y^2 + r^2))/2";
  e.source = "Merritt 1967, 5.4 (radial clearance and rounded edges)";
  e.plain = "Erosion has rounded the edge: look at the oil's cleanliness; the valve leaks about its null.";
  e.german = {
      fmt::format("Kante {} des Ventils {} ist verschlissen", edge, joint),
      "Erosion hat die Kante gerundet: Sauberkeit des Öls prüfen; das Ventil leckt um seinen Nullpunkt."};
  e.parameters = {{"r", 0.01, 0, 0.3, "1"}};
  const int chamber = EdgeChamber(edge);
  const std::string y =
      fmt::format("({}y_{})", EdgeOpening(edge, joint).find('-') == std::string::npos ? "" : "-", joint);
  e.adds = {
      {fmt::format("P_{}{}", joint, chamber),
       fmt::format("{}{}*{}*{}*(0.5*({} + sqrt({}^2 + r^2 + 1e-12)) - {})", EdgeSign(edge) > 0 ? "" : "-",
                   Stiffness(joint, chamber), EdgeCoefficient(edge, joint), EdgeRoot(edge, joint), y, y,
                   EdgeOpening(edge, joint))}};
  return e;
}

}  // namespace hydroscope::manipulator
