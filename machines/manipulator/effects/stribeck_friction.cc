#include <fmt/format.h>

#include "machines/manipulator/effects/effects.h"
#include "machines/manipulator/equations.h"

namespace hydroscope::manipulator {

Effect StribeckFriction(int joint) {
  Effect e;
  e.id = fmt::format("stribeck_friction_{}", joint);
  e.title = fmt::format("Stribeck friction of cylinder {}", joint);
  e.law = "F = F_s exp(-(v/v_s)^2) sign(v)";
  e.source = "Stribeck 1902; Armstrong-Helouvry 1994";
  e.plain = "The seals stick near standstill: look at the oil film, the rod's surface and side loads.";
  e.german = {fmt::format("Stribeck-Reibung des Zylinders {}", joint),
              "Die Dichtungen haften nahe dem Stillstand: Ölfilm, Stangenoberfläche und Querkräfte prüfen."};
  e.parameters = {{"F_s", 500, 0, 5e4, "N"}, {"v_s", 0.01, 0.002, 0.1, "m/s"}};
  const std::string speed = PistonSpeed(StateJoint(joint));
  const std::string torque =
      fmt::format("{0}*F_s*exp(-({1}/v_s)^2)*tanh({1}/0.001)", Lever(StateJoint(joint)), speed);
  for (const int of : {1, 2})
    e.adds.push_back({StateJoint(of).speed, fmt::format("-{}*{}", Mobility(of, joint), torque)});
  return e;
}

}  // namespace hydroscope::manipulator
