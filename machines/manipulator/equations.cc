#include "machines/manipulator/equations.h"

#include <fmt/format.h>

#include "machines/manipulator/parameters.h"

namespace hydroscope::manipulator {
namespace {

/// `text` with {i} the number of the joint, {q} its angle, {w} its speed.
std::string Of(const Joint& joint, const std::string& text) {
  return fmt::format(fmt::runtime(text), fmt::arg("i", joint.number), fmt::arg("q", joint.angle),
                     fmt::arg("w", joint.speed));
}

std::string Length(const Joint& joint) {
  return Of(joint, "sqrt(l1_{i}^2 + l2_{i}^2 - 2*l1_{i}*l2_{i}*cos({q} + q0_{i}))");
}

/// Speed over which Coulomb friction turns, m/s: far below what friction differs at, far above what noise makes of rest.
constexpr const char* kTurning = "0.001";
/// Pressure difference, Pa, below which an edge passes as much as at it: the root stays smooth.
constexpr const char* kLeastDifference = "1e4";

std::string Volume(const Joint& joint, int chamber) {
  return chamber == 1 ? Of(joint, "(V_{i} + A1_{i}*(" + Position(joint) + "))")
                      : Of(joint, "(V_{i} + A2_{i}*(S_{i} - (" + Position(joint) + ")))");
}

std::string StatePressure(int joint, int chamber) { return fmt::format("P_{}{}", joint, chamber); }
std::string MeasuredPressure(int joint, int chamber) { return fmt::format("p_{}{}", joint, chamber); }

std::string RootOf(const std::string& edge, const std::string& pressure) {
  const std::string difference = edge.front() == 'P' ? "p_s - " + pressure : pressure + " - p_t";
  return fmt::format("sqrt(max({}, {}))", difference, kLeastDifference);
}

/// Terms of friction in the torque balance.
void AddFriction(const Joint& joint, LinearForm::Equation& equation) {
  const std::string lever = Lever(joint), speed = PistonSpeed(joint);
  equation.terms.push_back({Of(joint, "b_{i}"), "", fmt::format("{}*{}", lever, speed)});
  equation.terms.push_back({Of(joint, "F_c_{i}"), "", fmt::format("{}*tanh({}/{})", lever, speed, kTurning)});
}

/// Lagrange's equation of a joint, each term linear in one standard parameter: momentum dT/dw and dU/dq - dT/dq.
LinearForm::Equation TorqueBalance(int number) {
  LinearForm::Equation e;
  e.name = fmt::format("torque of joint {}", number);
  if (number == 1) {
    e.terms = {{"m_1", "", "0*q_1"},
               {"mx_1", "", "g*cos(q_1)"},
               {"my_1", "", "-g*sin(q_1)"},
               {"J_1", "w_1", ""},
               {"m_2", "a_1^2*w_1", "g*a_1*cos(q_1)"},
               {"mx_2", "a_1*cos(q_2)*(2*w_1 + w_2)", "g*cos(q_1 + q_2)"},
               {"my_2", "-a_1*sin(q_2)*(2*w_1 + w_2)", "-g*sin(q_1 + q_2)"},
               {"J_2", "w_1 + w_2", ""}};
  } else {
    e.terms = {{"mx_2", "a_1*cos(q_2)*w_1", "g*cos(q_1 + q_2) + a_1*sin(q_2)*w_1*(w_1 + w_2)"},
               {"my_2", "-a_1*sin(q_2)*w_1", "-g*sin(q_1 + q_2) + a_1*cos(q_2)*w_1*(w_1 + w_2)"},
               {"J_2", "w_1 + w_2", ""}};
  }
  const Joint joint = MeasuredJoint(number);
  AddFriction(joint, e);
  e.known_level = Of(joint, Lever(joint) + "*(p_{i}1*A1_{i} - p_{i}2*A2_{i})");
  return e;
}

/// Oil of a chamber: what it is compressed by, what the edges pass, what the piston makes room for.
LinearForm::Equation FlowBalance(int number, int chamber) {
  const Joint joint = MeasuredJoint(number);
  const std::string pressure = MeasuredPressure(number, chamber), sign = chamber == 1 ? "" : "-";
  LinearForm::Equation e;
  e.name = fmt::format("flow of chamber {}{}", number, chamber);
  e.terms.push_back({Of(joint, "1/K_{i}"), pressure + "*" + Volume(joint, chamber),
                     fmt::format("{}*{}A{}_{}*{}", pressure, chamber == 1 ? "(-1)*" : "", chamber, number,
                                 PistonSpeed(joint))});
  for (const char* edge : kEdges)
    if (EdgeChamber(edge) == chamber)
      e.terms.push_back({EdgeCoefficient(edge, number), "",
                         fmt::format("{}{}*{}", EdgeSign(edge) > 0 ? "-" : "", EdgeOpening(edge, number),
                                     RootOf(edge, pressure))});
  e.known_rate = fmt::format("{}A{}_{}*({})", chamber == 1 ? "-" : "", chamber, number, Position(joint));
  return e;
}

/// `text` with the names in braces replaced by those of `base`.
std::string With(const BaseParameters& base, const char* text) {
  return fmt::format(fmt::runtime(text), fmt::arg("mx_1", base.mx_1), fmt::arg("my_1", base.my_1),
                     fmt::arg("J_1", base.J_1), fmt::arg("mx_2", base.mx_2), fmt::arg("my_2", base.my_2),
                     fmt::arg("J_2", base.J_2));
}

/// M = [first, coupled; coupled, second] and its determinant, with h = a_1 (mx_2 cos q_2 - my_2 sin q_2):
/// first = J_1 + J_2 + 2 h, coupled = J_2 + h, second = J_2, det M = J_1 J_2 - h^2.
struct MassMatrix {
  std::string first, coupled, second, determinant;
};
MassMatrix MassMatrixOf(const BaseParameters& base) {
  const std::string h = With(base, "a_1*({mx_2}*cos(angle_2) - {my_2}*sin(angle_2))");
  return {With(base, "({J_1} + {J_2} + 2*") + h + ")", With(base, "({J_2} + ") + h + ")", With(base, "{J_2}"),
          With(base, "({J_1}*{J_2} - (") + h + ")^2)"};
}

}  // namespace

Joint StateJoint(int number) {
  return {number, fmt::format("angle_{}", number), fmt::format("speed_{}", number)};
}
Joint MeasuredJoint(int number) { return {number, fmt::format("q_{}", number), fmt::format("w_{}", number)}; }

std::string Position(const Joint& joint) { return Of(joint, Length(joint) + " - x0_{i}"); }
std::string Lever(const Joint& joint) {
  return Of(joint, "l1_{i}*l2_{i}*sin({q} + q0_{i})/" + Length(joint));
}
std::string PistonSpeed(const Joint& joint) { return Lever(joint) + "*" + joint.speed; }

std::string CylinderForce(int number) {
  const Joint joint = StateJoint(number);
  const std::string speed = PistonSpeed(joint);
  return Of(joint, "(P_{i}1*A1_{i} - P_{i}2*A2_{i} - b_{i}*" + speed + " - F_c_{i}*tanh(" + speed + "/" +
                       kTurning + "))");
}
std::string CylinderTorque(int number) { return Lever(StateJoint(number)) + "*" + CylinderForce(number); }

Accelerations AccelerationsOf(const BaseParameters& base, const std::string& torque_1,
                              const std::string& torque_2) {
  const MassMatrix m = MassMatrixOf(base);
  const std::string bend = With(base, "a_1*({mx_2}*sin(angle_2) + {my_2}*cos(angle_2))");
  const std::string weight_2 =
      With(base, "g*({mx_2}*cos(angle_1 + angle_2) - {my_2}*sin(angle_1 + angle_2))");
  const std::string weight_1 = With(base, "g*({mx_1}*cos(angle_1) - {my_1}*sin(angle_1))");
  const std::string t_1 =
      fmt::format("({} + {}*speed_2*(2*speed_1 + speed_2) - {} - {})", torque_1, bend, weight_1, weight_2);
  const std::string t_2 = fmt::format("({} - {}*speed_1^2 - {})", torque_2, bend, weight_2);
  return {fmt::format("({}*{} - {}*{})/{}", m.second, t_1, m.coupled, t_2, m.determinant),
          fmt::format("({}*{} - {}*{})/{}", m.first, t_2, m.coupled, t_1, m.determinant)};
}

std::string Mobility(int of, int torque) {
  const MassMatrix m = MassMatrixOf({});
  if (of != torque) return fmt::format("(-{}/{})", m.coupled, m.determinant);
  return fmt::format("({}/{})", of == 1 ? m.second : m.first, m.determinant);
}

std::string EdgeCoefficient(const std::string& edge, int joint) {
  return fmt::format("C_{}_{}", edge, joint);
}
int EdgeChamber(const std::string& edge) { return edge.find('A') == std::string::npos ? 2 : 1; }
int EdgeSign(const std::string& edge) { return edge.front() == 'P' ? 1 : -1; }
std::string EdgeOpening(const std::string& edge, int joint) {
  return fmt::format("max({}y_{}, 0)", edge == "PA" || edge == "BT" ? "" : "-", joint);
}
std::string EdgeRoot(const std::string& edge, int joint) {
  return RootOf(edge, StatePressure(joint, EdgeChamber(edge)));
}

std::string Stiffness(int number, int chamber) {
  return fmt::format("K_{}/{}", number, Volume(StateJoint(number), chamber));
}

std::string PressureRate(int number, int chamber, const std::string& flow_in) {
  return fmt::format("{}*({} {} A{}_{}*{})", Stiffness(number, chamber), flow_in, chamber == 1 ? "-" : "+",
                     chamber, number, PistonSpeed(StateJoint(number)));
}

std::string PressureRate(int number, int chamber) {
  std::string flow;
  for (const char* edge : kEdges)
    if (EdgeChamber(edge) == chamber)
      flow += fmt::format("{}{}*{}*{}",
                          flow.empty()         ? ""
                          : EdgeSign(edge) > 0 ? " + "
                                               : " - ",
                          EdgeCoefficient(edge, number), EdgeOpening(edge, number), EdgeRoot(edge, number));
  return PressureRate(number, chamber, flow);
}

StatesSpec States(const Machine& machine) {
  StatesSpec spec;
  const Accelerations a = AccelerationsOf({}, CylinderTorque(1), CylinderTorque(2));
  for (const int i : {1, 2}) {
    const Joint joint = StateJoint(i);
    spec.states.push_back({joint.angle, joint.speed, "estimate", "", "", "rad"});
    spec.states.push_back({joint.speed, i == 1 ? a.first : a.second, "estimate", "", "", "rad/s"});
    spec.outputs.push_back({fmt::format("q_{}", i), joint.angle});
    for (const int chamber : {1, 2}) {
      spec.states.push_back({StatePressure(i, chamber), PressureRate(i, chamber), "estimate", "", "", "Pa"});
      spec.outputs.push_back({MeasuredPressure(i, chamber), StatePressure(i, chamber)});
    }
  }
  for (const ParameterSpec& p : ParameterRanges())
    if (!machine.Geometry(p.name)) spec.parameters.push_back(p);
  return spec;
}

LinearForm Linear(const Machine&) {
  LinearForm form;
  form.rates = {{"q_1", "w_1"}, {"q_2", "w_2"}};
  for (const int i : {1, 2}) form.equations.push_back(TorqueBalance(i));
  for (const int i : {1, 2})
    for (const int chamber : {1, 2}) form.equations.push_back(FlowBalance(i, chamber));
  // Masses stand last: what they add to moments and inertias is told by those.
  form.parameters = {"mx_1", "my_1", "J_1", "mx_2", "my_2", "J_2", "b_1", "F_c_1", "b_2", "F_c_2"};
  for (const int i : {1, 2}) {
    form.parameters.push_back(fmt::format("1/K_{}", i));
    for (const char* edge : kEdges) form.parameters.push_back(EdgeCoefficient(edge, i));
  }
  form.parameters.insert(form.parameters.end(), {"m_1", "m_2"});
  return form;
}

}  // namespace hydroscope::manipulator
