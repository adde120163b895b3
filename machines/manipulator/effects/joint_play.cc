#include <fmt/format.h>

#include "machines/manipulator/effects/effects.h"
#include "machines/manipulator/equations.h"

namespace hydroscope::manipulator {

/// A rod that weighs nothing lies at one end of the clearance or the other, as the force says: it moves by
/// (play/2) tanh(F/F_0), a softness c = play/(2 F_0) / cosh^2(F/F_0) about the reversal of the load. With k the stiffness of the
/// oil the force then changes by F'/(1 + c k), and the piston goes c times that faster than the joint. F_0 stays small against the
/// loads of an arm: spread over all of them the law would be a soft rod, which the jitter of the spools looks like.
Effect JointPlay(int joint) {
  Effect e;
  e.id = fmt::format("joint_play_{}", joint);
  e.title = fmt::format("Play between cylinder {} and its joint", joint);
  e.law = "x = x(q) + (play/2) tanh(F/F_0)";
  e.source = "dead zone of a rod without mass, smoothed";
  e.plain =
      "Pin or bush is worn: the joint stands while the piston crosses the clearance when the load reverses.";
  e.german = {fmt::format("Spiel zwischen Zylinder {} und seinem Gelenk", joint),
              "Bolzen oder Buchse ist verschlissen: das Gelenk steht, während der Kolben bei Lastumkehr das "
              "Spiel durchläuft."};
  e.parameters = {{"play", 5e-4, 0, 0.02, "m"}, {"F_0", 1000, 200, 5000, "N"}};
  const std::string soft = fmt::format("play/(2*F_0*cosh(min(abs({}/F_0), 50))^2)", CylinderForce(joint));
  const std::string stiff =
      fmt::format("(A1_{0}^2*{1} + A2_{0}^2*{2})", joint, Stiffness(joint, 1), Stiffness(joint, 2));
  const std::string rate =
      fmt::format("(A1_{0}*{1} - A2_{0}*{2})", joint, PressureRate(joint, 1), PressureRate(joint, 2));
  const std::string faster = fmt::format("{0}*{1}/(1 + {0}*{2})", soft, rate, stiff);
  e.adds = {{fmt::format("P_{}1", joint), fmt::format("-A1_{}*{}*{}", joint, Stiffness(joint, 1), faster)},
            {fmt::format("P_{}2", joint), fmt::format("A2_{}*{}*{}", joint, Stiffness(joint, 2), faster)}};
  return e;
}

}  // namespace hydroscope::manipulator
