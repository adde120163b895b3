#include "machines/pump/kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "machines/inputs.h"
#include "machines/pump/effects/effects.h"
#include "machines/pump/equations.h"

namespace hydroscope {
namespace {

// Control pressure, and the outlet of a pump that turns.
constexpr PlausibleSize kControl{0, 1e8}, kOutlet{1e5, 1e8};

constexpr std::array<MachineInput, 5> kPumpSignals = {{
    Measured("shaft_speed", "rad/s", {"speed of the shaft", "Drehzahl der Welle"},
             "n speed drehzahl npump omega", PlausibleSize{1, 1000}),
    Measured("load_flow", "m3/s", {"flow into the load", "Volumenstrom in die Last"},
             "q flow volumenstrom durchfluss qload qlast", PlausibleSize{1e-6, 0.1}),
    Measured("outlet_pressure", "Pa", {"pressure at the outlet", "Druck am Ausgang"},
             "ps p pout poutlet pumpendruck systemdruck", kOutlet),
    MayBeMeasured("control_pressure", "Pa", {"pressure in the control chamber", "Druck in der Stellkammer"},
                  "pc pcontrol stelldruck", kControl),
    MayBeMeasured("control_position", "m",
                  {"position of the control piston, 0 at full displacement",
                   "Weg des Stellkolbens, 0 bei vollem Fördervolumen"},
                  "xp xc stellkolben stellweg", PlausibleSize{1e-6, 1, PlausibleSize::kTravel}),
}};

constexpr std::array<MachineInput, 14> kPumpGeometry = {{
    Known("D_max", "m3",
          {"largest displacement, per radian of the shaft", "größtes Fördervolumen, je Radiant der Welle"},
          1e-8, 1e-3, "cm3"),
    Known("X_p", "m",
          {"stroke of the control piston to no displacement", "Weg des Stellkolbens bis zur Nullförderung"},
          1e-4, 1),
    Known("A_p", "m2", {"area of the control piston", "Fläche des Stellkolbens"}, 1e-6, 1),
    Known("A_v", "m2", {"area of the compensator spool", "Fläche des Reglerschiebers"}, 1e-7, 1e-2),
    Known("m_p", "kg",
          {"mass of the control piston, with what it moves of the swash plate",
           "Masse des Stellkolbens, mit dem, was er von der Schrägscheibe bewegt"},
          1e-3, 1e3),
    Known("m_v", "kg", {"mass of the compensator spool", "Masse des Reglerschiebers"}, 1e-4, 10),
    Known("b_p", "N s/m", {"viscous friction of the control piston", "viskose Reibung des Stellkolbens"},
          1e-1, 1e6),
    Known("b_v", "N s/m",
          {"viscous friction of the compensator spool", "viskose Reibung des Reglerschiebers"}, 1e-2, 1e5),
    Known("V_c", "m3",
          {"volume of the control chamber at full displacement",
           "Volumen der Stellkammer bei vollem Fördervolumen"},
          1e-8, 1, "cm3"),
    Known("E", "Pa", {"bulk modulus of the oil", "Kompressionsmodul des Öls"}, 1e8, 1e10),
    Assumed("X_v", "m",
            {"stroke of the compensator spool to either side", "Weg des Reglerschiebers zu jeder Seite"},
            1e-3),
    TankPressure(),
    Assumed("dp_n", "Pa",
            {"pressure drop over an edge that K_q is stated at",
             "Druckabfall an einer Kante, für den K_q angegeben ist"},
            1e7),
    Assumed("dp_lam", "Pa",
            {"difference below which flow through an edge is laminar",
             "Druckunterschied, unter dem eine Kante laminar durchströmt wird"},
            1e3),
}};

constexpr std::array<MachineParameter, 9> kPumpParameters = {{
    Identified("K_v", "N/m", {"stiffness of the compensator spring", "Steifigkeit der Reglerfeder"},
               {"The compensator spring; a weak or cracked one is softer.",
                "Die Feder des Reglers; eine schwache oder gebrochene ist weicher."},
               "K_{v}"),
    Identified("K_q", "m2/s",
               {"flow gain of the compensator's edges", "Durchflussverstärkung der Reglerkanten"},
               {"Flow through a metering edge per opening; it grows as the edges wear.",
                "Durchfluss einer Steuerkante je Öffnung; er wächst, wenn die Kanten verschleißen."},
               "K_{q}"),
    Identified("C_l", "m3/(s Pa)", {"leakage of the control chamber", "Leckage der Stellkammer"},
               {"Leakage past control piston and bleed to the case; it grows as the pump wears.",
                "Leckage am Stellkolben und Abfluss ins Gehäuse; sie wächst mit dem Verschleiß der Pumpe."},
               "C_{l}"),
    Identified(
        "K_p", "N/m", {"stiffness of the control piston's spring", "Steifigkeit der Stellkolbenfeder"},
        {"The spring that swings the swash plate out.", "Die Feder, die die Schrägscheibe ausschwenkt."},
        "K_{p}"),
    OverOil(OilLaw::kNone,
            Identified("V_t", "m3", {"volume between pump and load", "Volumen zwischen Pumpe und Last"},
                       {"Line volume; air in the oil makes it seem larger.",
                        "Volumen der Leitung; Luft im Öl lässt es größer scheinen."},
                       "V_{t}", "l", 1e3)),
    Identified("F_0", "N", {"preload of the compensator spring", "Vorspannung der Reglerfeder"},
               {"What the set pressure is adjusted by; it falls as the spring sets.",
                "Damit wird der Solldruck eingestellt; sie fällt, wenn die Feder sich setzt."},
               "F_{0}"),
    Identified("T_q", "s", {"lag of the flow sensor", "Verzug des Durchflusssensors"},
               {"Time constant of the flow sensor.", "Zeitkonstante des Durchflusssensors."}, "T_{q}", "ms",
               1e3),
    Identified(
        "R_p", "1",
        {"share of the pressure ripple that moves the compensator spool",
         "Anteil der Druckpulsation, der den Reglerschieber bewegt"},
        {"Below 1: the slow ripple at the outlet holds the pump's own answer, and lines dampen it.",
         "Unter 1: In der langsamen Pulsation am Ausgang steckt die eigene Antwort der Pumpe, und Leitungen dämpfen sie."},
        "R_{p}"),
    Identified(
        "r_e", "m",
        {"opening over which the compensator's edges are round",
         "Öffnung, über die die Kanten des Reglers rund sind"},
        {"Edges are not sharp, and the fast ripple shakes the spool over its null; it grows as edges wear.",
         "Kanten sind nicht scharf, und die schnelle Pulsation rüttelt den Schieber über seine Mitte; sie wächst mit dem Verschleiß der Kanten."},
        "r_{e}", "µm", 1e6),
}};

/// Start of each parameter is that of a pump of 100 l/min; the range reaches a factor of 5 to both sides.
ParameterSpec PumpParameter(const char* name, double start, const char* unit) {
  constexpr double kReach = 5;
  return {.name = name, .start = start, .min = start / kReach, .max = start * kReach, .unit = unit};
}

/// Position of the control piston while the pump delivers what the load takes.
constexpr char kAtRest[] = "X_p*(1 - load_flow/(shaft_speed*D_max))";

StatesSpec PumpStates(const Machine& machine) {
  StatesSpec spec;
  const bool ripples = !machine.states.shaft.empty();
  // The outlet pressure alone does not tell how round edges are.
  const bool round = ripples && std::ranges::any_of(machine.signals, [](const SignalSpec& signal) {
                       return signal.name == "control_pressure" || signal.name == "control_position";
                     });
  spec.states = {
      {.name = "p_c",
       .ddt = fmt::format("{}*({} - {} - C_l*p_c - A_p*v_p)", pump::ChamberStiffness(), pump::FlowIn(round),
                          pump::FlowOut(round)),
       .min = "0",
       .unit = "Pa",
       .near = fmt::format("K_p*{}/A_p", kAtRest)},
      {.name = "p",
       .ddt = fmt::format("{}*({} - {} - A_v*v_v - load_flow)", pump::LineStiffness(), pump::Delivered(),
                          pump::FlowIn(round)),
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
       .ddt = fmt::format("(A_v*({}{}) - K_v*x_v - b_v*v_v - F_0)/m_v", pump::OutletPressure(),
                          ripples ? " + R_p*outlet_pressure_ripple" : ""),
       .initial = "0",
       .unit = "m/s"},
  };
  spec.outputs = {
      {"outlet_pressure", pump::OutletPressure()}, {"control_pressure", "p_c"}, {"control_position", "x_p"}};
  spec.parameters = {PumpParameter("K_v", 2e5, "N/m"),         PumpParameter("K_q", 0.5, "m2/s"),
                     PumpParameter("C_l", 2e-11, "m3/(s Pa)"), PumpParameter("K_p", 1.5e5, "N/m"),
                     PumpParameter("V_t", 4e-3, "m3"),         PumpParameter("F_0", 1000, "N"),
                     PumpParameter("T_q", 6e-3, "s")};
  if (ripples) spec.parameters.push_back({.name = "R_p", .start = 0.8, .min = 0, .max = 2, .unit = "1"});
  if (round) spec.parameters.push_back({.name = "r_e", .start = 2e-6, .min = 2e-7, .max = 2e-5, .unit = "m"});
  return spec;
}

/// Readings are means over revolutions, so that the ripple of the pistons stays out.
void CompletePump(const LogSample& log, const std::map<std::string, double>&, MachineDraft& draft) {
  if (!log.signals.contains("shaft_speed")) return;
  draft.machine.states.shaft = "shaft_speed";
  draft.decided.emplace_back("the ripple of the pistons is taken out over revolutions of the shaft",
                             "die Pulsation der Kolben wird über Umdrehungen der Welle herausgenommen");
}

MachineWords PumpWords(const Machine&) {
  return {.output = {"pressure at the outlet", "Druck am Ausgang"},
          .stroke = {"episode", "Episode"},
          .vary = {"the load flow in steps over the whole range, some tenths of a second each",
                   "der Volumenstrom der Last in Stufen über den ganzen Bereich, je einige Zehntelsekunden"}};
}

}  // namespace

const MachineKind kPump = {.id = "pump",
                           .title = {"pressure-compensated pump", "druckgeregelte Pumpe"},
                           .signals = kPumpSignals,
                           .geometry = kPumpGeometry,
                           .parameters = kPumpParameters,
                           .output_unit = "Pa",
                           .has_states = true,
                           .states = PumpStates,
                           .words = PumpWords,
                           .picture = PumpPicture,
                           .draft = {nullptr, CompletePump},
                           .effects = PumpEffects};

}  // namespace hydroscope
