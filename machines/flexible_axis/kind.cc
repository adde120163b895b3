#include "machines/flexible_axis/kind.h"

#include <array>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"

namespace hydroscope {
namespace {

namespace axis = flexible_axis;

constexpr std::array<MachineInput, 6> kAxisSignals = {{
    {.name = "U", .si = "V", .required = true, .meaning = "command of the valve"},
    {.name = "position", .si = "m", .required = true, .meaning = "position of the piston"},
    {.name = "load_position", .si = "m", .required = false, .meaning = "position of the load"},
    {.name = "acceleration", .si = "m/s2", .required = false, .meaning = "acceleration of the piston"},
    {.name = "pressure_1", .si = "Pa", .required = true, .meaning = "pressure on the piston side"},
    {.name = "pressure_2", .si = "Pa", .required = true, .meaning = "pressure on the rod side"},
}};

constexpr std::array<MachineInput, 17> kAxisGeometry = {{
    {"m_1", "kg", true, "mass of piston, rod and what is bolted to it", true, 0.1, 1e6, "kg"},
    {"m_2", "kg", true, "mass of the load", true, 0.1, 1e6, "kg"},
    {"A_1", "m2", true, "area of the piston", true, 1e-6, 10, "m2"},
    {"A_2", "m2", true, "area of the ring on the rod side", true, 1e-6, 10, "m2"},
    {"V_01", "m3", true, "pipe and dead volume of the piston side", true, 1e-8, 10, "m3"},
    {"V_02", "m3", true, "pipe and dead volume of the rod side", true, 1e-8, 10, "m3"},
    {"L", "m", true, "stroke", true, 1e-3, 100, "m"},
    {"p_s", "Pa", true, "supply pressure", true, 1e5, 1e8, "Pa"},
    {"p_t", "Pa", false, "tank pressure", false, 0, 0, "", false, 0.0},
    {"k", "N/m", true, "stiffness of the spring between piston and load", true, 1, 1e12, "N/m"},
    {"U_n", "V", false, "command of the nominal flow", true, 0, 0, "", false, 10.0},
    {"dp_n", "Pa", false, "pressure drop over one edge at the nominal flow", true, 0, 0, "", false, 35e5},
    {"p_low", "Pa", false, "pressure that beta_2 is stated at", true, 0, 0, "", false, 2e6},
    {"p_high", "Pa", false, "pressure that beta_10 is stated at", true, 0, 0, "", false, 10e6},
    {"dp_lam", "Pa", false, "difference below which flow through an edge is laminar", true, 0, 0, "", false,
     100.0},
    {"p_atm", "Pa", false, "pressure of the atmosphere, absolute", true, 0, 0, "", false, 1e5},
    {"v_dry", "m/s", false, "speed below which dry friction of the load's guide sets in gradually", true, 0,
     0, "", false, 1e-3},
}};

constexpr std::array<MachineParameter, 15> kAxisParameters = {{
    {"Q_n", "m3/s", "nominal flow of the valve", "Q_{n}",
     "The flow through one edge at 10 V and 35 bar; wear raises it.", "l/min", 6e4},
    {"tau", "s", "time constant of the spool", "\\tau",
     "A spool that sticks, or a weak pilot, makes it longer.", "ms", 1e3},
    {"b", "N s/m", "damping between piston and load", "b", "The damper beside the spring."},
    {"L_i", "m3/(s Pa)", "internal leakage", "L_{i}",
     "Flow past the piston seal; it grows as the seal wears."},
    {"L_e1", "m3/(s Pa)", "leakage of the piston side", "L_{e1}", "Flow from the piston side to tank."},
    {"L_e2", "m3/(s Pa)", "leakage of the rod side", "L_{e2}",
     "Flow from the rod side to tank; the rod seal."},
    {"beta_2", "Pa", "bulk modulus at 2 MPa", "\\beta_{2}", "Air in the oil and soft hoses lower it.", "bar",
     1e-5},
    {"beta_10", "Pa", "bulk modulus at 10 MPa", "\\beta_{10}", "Air in the oil and soft hoses lower it.",
     "bar", 1e-5},
    {"p_0", "Pa", "how the bulk modulus bends between them", "p_{0}",
     "Shape of the law over pressure; beta_2 and beta_10 hold its size.", "bar", 1e-5},
    {"sigma_0", "N/m", "stiffness of the bristles", "\\sigma_{0}",
     "Elasticity of the seals before they slip."},
    {"sigma_1", "N s/m", "damping of the bristles", "\\sigma_{1}", "Damping of the seals before they slip."},
    {"k_v", "N s/m", "viscous friction", "k_{v}",
     "Friction that grows with speed; it falls as the oil warms up."},
    {"F_c", "N", "Coulomb friction", "F_{c}", "Friction of the seals while they slide."},
    {"F_s", "N", "static friction beyond F_c", "F_{s}",
     "What it takes more to break away: dry or swollen seals."},
    {"v_s", "m/s", "Stribeck speed", "v_{s}", "Speed at which the extra friction of rest is gone.", "mm/s",
     1e3},
}};

/// Start of each parameter: that of the published axis; the range reaches a factor of 30 to both sides.
ParameterSpec Around(const char* name, double start, const char* unit) {
  constexpr double kReach = 30;
  return {.name = name, .start = start, .min = start / kReach, .max = start * kReach, .unit = unit};
}

StatesSpec AxisStates(const Machine&) {
  StatesSpec spec;
  spec.states = {
      {.name = "x_p", .ddt = "v_p", .unit = "m"},
      {.name = "v_p", .ddt = axis::Acceleration(), .initial = "0", .unit = "m/s"},
      {.name = "x_l", .ddt = "v_l", .unit = "m"},
      {.name = "v_l", .ddt = axis::SpringForce() + "/m_2", .initial = "0", .unit = "m/s"},
      {.name = "p_1", .ddt = axis::PressureRate(1), .unit = "Pa"},
      {.name = "p_2", .ddt = axis::PressureRate(2), .unit = "Pa"},
      {.name = "x_s", .ddt = "(U - x_s)/tau", .initial = "U", .unit = "V"},
      {.name = "f", .ddt = "sigma_0*" + axis::BristleRate(), .unit = "N"},
  };
  spec.outputs = {{"position", "x_p"},
                  {"load_position", "x_l"},
                  {"acceleration", axis::Acceleration()},
                  {"pressure_1", "p_1"},
                  {"pressure_2", "p_2"}};
  spec.parameters = {Around("Q_n", 4.6e-4, "m3/s"),
                     Around("tau", 2e-3, "s"),
                     Around("b", 420, "N s/m"),
                     Around("L_i", 1.7e-13, "m3/(s Pa)"),
                     Around("L_e1", 2.4e-12, "m3/(s Pa)"),
                     Around("L_e2", 1e-13, "m3/(s Pa)"),
                     Around("beta_2", 5.5e8, "Pa"),
                     Around("beta_10", 6.7e8, "Pa"),
                     Around("p_0", 6e6, "Pa"),
                     Around("sigma_0", 1e6, "N/m"),
                     Around("sigma_1", 400, "N s/m"),
                     Around("k_v", 400, "N s/m"),
                     Around("F_c", 250, "N"),
                     Around("F_s", 7000, "N"),
                     Around("v_s", 0.026, "m/s")};
  return spec;
}

MachineWords AxisWords(const Machine&) {
  return {"position, acceleration and pressures", "episode",
          "the command: a staircase of 0.2, 0.4, 0.8, 1.6 and 4 V to both sides, 0.4 s each", "", false};
}

/// Leakages show at small openings, the Stribeck curve at low speeds, the bulk modulus over pressure at large ones.
std::vector<InputCourse> AxisCourses(const Machine& machine) {
  const auto known = machine.geometry.find("U_n");
  const double nominal = known == machine.geometry.end() ? 10.0 : known->second.value;
  InputCourse staircase{"staircase", "U", {}, 0.4};
  for (const double level : {0.02, 0.04, 0.08, 0.16, 0.4})
    for (const double sign : {1.0, -1.0}) staircase.levels.push_back(sign * level * nominal);
  return {staircase};
}

}  // namespace

const MachineKind kFlexibleAxis = {.id = "flexible_axis",
                                   .title = "servo axis with a flexible load",
                                   .signals = kAxisSignals,
                                   .geometry = kAxisGeometry,
                                   .parameters = kAxisParameters,
                                   .output_unit = "m",
                                   .has_states = true,
                                   .states = AxisStates,
                                   .words = AxisWords,
                                   .effects = FlexibleAxisEffects,
                                   .experiment = {.courses = AxisCourses}};

}  // namespace hydroscope
