#include "machines/pump/kind.h"

#include <fmt/format.h>

#include <array>

#include "machines/pump/effects/effects.h"
#include "machines/pump/equations.h"

namespace hydroscope {
namespace {

constexpr std::array<MachineInput, 5> kPumpSignals = {{
    {.name = "shaft_speed", .si = "rad/s", .required = true, .meaning = "speed of the shaft"},
    {.name = "load_flow", .si = "m3/s", .required = true, .meaning = "flow into the load"},
    {.name = "outlet_pressure", .si = "Pa", .required = true, .meaning = "pressure at the outlet"},
    {.name = "control_pressure", .si = "Pa", .required = false, .meaning = "pressure in the control chamber"},
    {.name = "control_position",
     .si = "m",
     .required = false,
     .meaning = "position of the control piston, 0 at full displacement"},
}};

constexpr std::array<MachineInput, 15> kPumpGeometry = {{
    {"D_max", "m3", true, "largest displacement, per radian of the shaft", true, 1e-8, 1e-3, "m3"},
    {"X_p", "m", true, "stroke of the control piston to no displacement", true, 1e-4, 1, "m"},
    {"A_p", "m2", true, "area of the control piston", true, 1e-6, 1, "m2"},
    {"A_v", "m2", true, "area of the compensator spool", true, 1e-7, 1e-2, "m2"},
    {"m_p", "kg", true, "mass of the control piston, with what it moves of the swash plate", true, 1e-3, 1e3,
     "kg"},
    {"m_v", "kg", true, "mass of the compensator spool", true, 1e-4, 10, "kg"},
    {"b_p", "N s/m", true, "viscous friction of the control piston", true, 1e-1, 1e6, "N s/m"},
    {"b_v", "N s/m", true, "viscous friction of the compensator spool", true, 1e-2, 1e5, "N s/m"},
    {"V_c", "m3", true, "volume of the control chamber at full displacement", true, 1e-8, 1, "m3"},
    {"E", "Pa", true, "bulk modulus of the oil", true, 1e8, 1e10, "Pa"},
    {"X_v", "m", false, "stroke of the compensator spool to either side", true, 0, 0, "", false, 1e-3},
    {"p_t", "Pa", false, "tank pressure", false, 0, 0, "", false, 0.0},
    {"dp_n", "Pa", false, "pressure drop over an edge that K_q is stated at", true, 0, 0, "", false, 1e7},
    {"dp_lam", "Pa", false, "difference below which flow through an edge is laminar", true, 0, 0, "", false,
     1e3},
    {"v_dry", "m/s", false, "speed over which dry friction sets in", true, 0, 0, "", false, 1e-2},
}};

constexpr std::array<MachineParameter, 7> kPumpParameters = {{
    {"K_v", "N/m", "stiffness of the compensator spring", "K_{v}",
     "The compensator spring; a weak or cracked one is softer."},
    {"K_q", "m2/s", "flow gain of the compensator's edges", "K_{q}",
     "Flow through a metering edge per opening; it grows as the edges wear."},
    {"C_l", "m3/(s Pa)", "leakage of the control chamber", "C_{l}",
     "Leakage past control piston and bleed to the case; it grows as the pump wears."},
    {"K_p", "N/m", "stiffness of the control piston's spring", "K_{p}",
     "The spring that swings the swash plate out."},
    {"V_t", "m3", "volume between pump and load", "V_{t}",
     "Line volume; air in the oil makes it seem larger.", "l", 1e3},
    {"F_0", "N", "preload of the compensator spring", "F_{0}",
     "What the set pressure is adjusted by; it falls as the spring sets."},
    {"T_q", "s", "lag of the flow sensor", "T_{q}", "Time constant of the flow sensor.", "ms", 1e3},
}};

/// Start of each parameter is that of a pump of 100 l/min; the range reaches a factor of 5 to both sides.
ParameterSpec PumpParameter(const char* name, double start, const char* unit) {
  constexpr double kReach = 5;
  return {.name = name, .start = start, .min = start / kReach, .max = start * kReach, .unit = unit};
}

/// Position of the control piston while the pump delivers what the load takes.
constexpr char kAtRest[] = "X_p*(1 - load_flow/(shaft_speed*D_max))";

StatesSpec PumpStates(const Machine&) {
  StatesSpec spec;
  spec.states = {
      {.name = "p_c",
       .ddt = fmt::format("{}*({} - {} - C_l*p_c - A_p*v_p)", pump::ChamberStiffness(), pump::FlowIn(),
                          pump::FlowOut()),
       .min = "0",
       .unit = "Pa",
       .near = fmt::format("K_p*{}/A_p", kAtRest)},
      {.name = "p",
       .ddt = fmt::format("{}*({} - {} - A_v*v_v - load_flow)", pump::LineStiffness(), pump::Delivered(),
                          pump::FlowIn()),
       .unit = "Pa",
       .near = "outlet_pressure + T_q*load_flow*" + pump::LineStiffness()},
      {.name = "x_p", .ddt = "v_p", .min = "0", .max = "X_p", .unit = "m", .near = kAtRest},
      {.name = "x_v",
       .ddt = "v_v",
       .min = "-X_v",
       .max = "X_v",
       .unit = "m",
       .near = "(A_v*outlet_pressure - F_0)/K_v"},
      {.name = "v_p", .ddt = "(A_p*p_c - K_p*x_p - b_p*v_p)/m_p", .initial = "0", .unit = "m/s"},
      {.name = "v_v",
       .ddt = fmt::format("(A_v*{} - K_v*x_v - b_v*v_v - F_0)/m_v", pump::OutletPressure()),
       .initial = "0",
       .unit = "m/s"},
  };
  spec.outputs = {
      {"outlet_pressure", pump::OutletPressure()}, {"control_pressure", "p_c"}, {"control_position", "x_p"}};
  spec.parameters = {PumpParameter("K_v", 2e5, "N/m"),         PumpParameter("K_q", 0.5, "m2/s"),
                     PumpParameter("C_l", 2e-11, "m3/(s Pa)"), PumpParameter("K_p", 1.5e5, "N/m"),
                     PumpParameter("V_t", 4e-3, "m3"),         PumpParameter("F_0", 1000, "N"),
                     PumpParameter("T_q", 6e-3, "s")};
  return spec;
}

MachineWords PumpWords(const Machine&) {
  return {"pressure at the outlet", "episode",
          "the load flow in steps over the whole range, some tenths of a second each", "", false};
}

}  // namespace

const MachineKind kPump = {.id = "pump",
                           .title = "pressure-compensated pump",
                           .signals = kPumpSignals,
                           .geometry = kPumpGeometry,
                           .parameters = kPumpParameters,
                           .output_unit = "Pa",
                           .has_states = true,
                           .states = PumpStates,
                           .words = PumpWords,
                           .effects = PumpEffects};

}  // namespace hydroscope
