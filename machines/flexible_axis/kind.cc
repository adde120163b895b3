#include "machines/flexible_axis/kind.h"

#include <array>

#include "machines/flexible_axis/effects/effects.h"
#include "machines/flexible_axis/equations.h"
#include "machines/inputs.h"

namespace hydroscope {
namespace {

namespace axis = flexible_axis;

constexpr PlausibleSize kTravelOfAxis{1e-4, 50, PlausibleSize::kTravel}, kChamber{1e5, 1e8};

constexpr std::array<MachineInput, 6> kAxisSignals = {{
    Measured("U", "V", {"command of the valve", "Ventilbefehl"}, "uv ucmd usoll ventilbefehl ventilspannung",
             PlausibleSize{0.01, 30}),
    Measured("position", "m", {"position of the piston", "Position des Kolbens"},
             "xp kolbenweg kolbenposition", kTravelOfAxis),
    MayBeMeasured("load_position", "m", {"position of the load", "Position der Last"},
                  "xl lastweg lastposition", kTravelOfAxis),
    MayBeMeasured("acceleration", "m/s2", {"acceleration of the piston", "Beschleunigung des Kolbens"},
                  "ap a beschleunigung"),
    Measured("pressure_1", "Pa", {"pressure on the piston side", "Druck auf der Kolbenseite"}, "p1",
             kChamber),
    Measured("pressure_2", "Pa", {"pressure on the rod side", "Druck auf der Stangenseite"}, "p2", kChamber),
}};

constexpr std::array<MachineInput, 17> kAxisGeometry = {{
    Known("m_1", "kg",
          {"mass of piston, rod and what is bolted to it",
           "Masse von Kolben, Stange und was daran befestigt ist"},
          0.1, 1e6),
    Known("m_2", "kg", {"mass of the load", "Masse der Last"}, 0.1, 1e6),
    Known("A_1", "m2", {"area of the piston", "Fläche des Kolbens"}, 1e-6, 10),
    Known("A_2", "m2", {"area of the ring on the rod side", "Ringfläche der Stangenseite"}, 1e-6, 10),
    Known("V_01", "m3",
          {"pipe and dead volume of the piston side", "Leitungs- und Totvolumen der Kolbenseite"}, 1e-8, 10),
    Known("V_02", "m3", {"pipe and dead volume of the rod side", "Leitungs- und Totvolumen der Stangenseite"},
          1e-8, 10),
    Known("L", "m", {"stroke", "Hub"}, 1e-3, 100),
    Known("p_s", "Pa", {"supply pressure", "Versorgungsdruck"}, 1e5, 1e8),
    TankPressure(),
    Known(
        "k", "N/m",
        {"stiffness of the spring between piston and load", "Steifigkeit der Feder zwischen Kolben und Last"},
        1, 1e12),
    Assumed("U_n", "V", {"command of the nominal flow", "Befehl des Nenndurchflusses"}, 10.0),
    Assumed(
        "dp_n", "Pa",
        {"pressure drop over one edge at the nominal flow", "Druckabfall an einer Kante beim Nenndurchfluss"},
        35e5),
    Assumed("p_low", "Pa", {"pressure that beta_2 is stated at", "Druck, für den beta_2 angegeben ist"}, 2e6),
    Assumed("p_high", "Pa", {"pressure that beta_10 is stated at", "Druck, für den beta_10 angegeben ist"},
            10e6),
    Assumed("dp_lam", "Pa",
            {"difference below which flow through an edge is laminar",
             "Druckunterschied, unter dem eine Kante laminar durchströmt wird"},
            100.0),
    Assumed("p_atm", "Pa", {"pressure of the atmosphere, absolute", "Luftdruck, absolut"}, 1e5),
    Assumed("v_dry", "m/s",
            {"speed below which dry friction of the load's guide sets in gradually",
             "Geschwindigkeit, unter der trockene Reibung der Lastführung allmählich einsetzt"},
            1e-3),
}};

constexpr std::array<MachineParameter, 15> kAxisParameters = {{
    OverOil(OilLaw::kViscosity,
            Identified("Q_n", "m3/s", {"nominal flow of the valve", "Nenndurchfluss des Ventils"},
                       {"The flow through one edge at 10 V and 35 bar; wear raises it.",
                        "Der Durchfluss einer Kante bei 10 V und 35 bar; Verschleiß erhöht ihn."},
                       "Q_{n}", "l/min", 6e4)),
    Identified("tau", "s", {"time constant of the spool", "Zeitkonstante des Schiebers"},
               {"A spool that sticks, or a weak pilot, makes it longer.",
                "Ein klemmender Schieber oder eine schwache Vorsteuerung macht sie länger."},
               "\\tau", "ms", 1e3),
    Identified("b", "N s/m", {"damping between piston and load", "Dämpfung zwischen Kolben und Last"},
               {"The damper beside the spring.", "Der Dämpfer neben der Feder."}, "b"),
    Identified("L_i", "m3/(s Pa)", {"internal leakage", "innere Leckage"},
               {"Flow past the piston seal; it grows as the seal wears.",
                "Strom an der Kolbendichtung vorbei; er wächst mit ihrem Verschleiß."},
               "L_{i}"),
    Identified("L_e1", "m3/(s Pa)", {"leakage of the piston side", "Leckage der Kolbenseite"},
               {"Flow from the piston side to tank.", "Strom von der Kolbenseite zum Tank."}, "L_{e1}"),
    Identified("L_e2", "m3/(s Pa)", {"leakage of the rod side", "Leckage der Stangenseite"},
               {"Flow from the rod side to tank; the rod seal.",
                "Strom von der Stangenseite zum Tank; die Stangendichtung."},
               "L_{e2}"),
    Identified("beta_2", "Pa", {"bulk modulus at 2 MPa", "Kompressionsmodul bei 2 MPa"},
               {"Air in the oil and soft hoses lower it.", "Luft im Öl und weiche Schläuche senken ihn."},
               "\\beta_{2}", "bar", 1e-5),
    Identified("beta_10", "Pa", {"bulk modulus at 10 MPa", "Kompressionsmodul bei 10 MPa"},
               {"Air in the oil and soft hoses lower it.", "Luft im Öl und weiche Schläuche senken ihn."},
               "\\beta_{10}", "bar", 1e-5),
    Identified(
        "p_0", "Pa",
        {"how the bulk modulus bends between them", "wie sich der Kompressionsmodul dazwischen krümmt"},
        {"Shape of the law over pressure; beta_2 and beta_10 hold its size.",
         "Form des Gesetzes über dem Druck; seine Größe steht in beta_2 und beta_10."},
        "p_{0}", "bar", 1e-5),
    Identified(
        "sigma_0", "N/m", {"stiffness of the bristles", "Steifigkeit der Borsten"},
        {"Elasticity of the seals before they slip.", "Nachgiebigkeit der Dichtungen, bevor sie gleiten."},
        "\\sigma_{0}"),
    Identified("sigma_1", "N s/m", {"damping of the bristles", "Dämpfung der Borsten"},
               {"Damping of the seals before they slip.", "Dämpfung der Dichtungen, bevor sie gleiten."},
               "\\sigma_{1}"),
    Identified("k_v", "N s/m", {"viscous friction", "viskose Reibung"},
               {"Friction that grows with speed; it falls as the oil warms up.",
                "Reibung, die mit der Geschwindigkeit wächst; sie fällt, wenn das Öl warm wird."},
               "k_{v}"),
    Identified("F_c", "N", {"Coulomb friction", "Coulombsche Reibung"},
               {"Friction of the seals while they slide.", "Reibung der Dichtungen, während sie gleiten."},
               "F_{c}"),
    Identified("F_s", "N", {"static friction beyond F_c", "Haftreibung über F_c hinaus"},
               {"What it takes more to break away: dry or swollen seals.",
                "Was es mehr braucht, um loszubrechen: trockene oder gequollene Dichtungen."},
               "F_{s}"),
    Identified("v_s", "m/s", {"Stribeck speed", "Stribeck-Geschwindigkeit"},
               {"Speed at which the extra friction of rest is gone.",
                "Geschwindigkeit, bei der die zusätzliche Haftreibung vorbei ist."},
               "v_{s}", "mm/s", 1e3),
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

void CompleteAxis(const LogSample&, const std::map<std::string, double>&, MachineDraft& draft) {
  draft.machine.log.hold = InputHold::kZero;
  draft.decided.emplace_back("the command is held from row to row",
                             "der Befehl wird von Zeile zu Zeile gehalten");
}

MachineWords AxisWords(const Machine&) {
  return {.output = {"position, acceleration and pressures", "Position, Beschleunigung und Drücke"},
          .stroke = {"episode", "Episode"},
          .vary = {"the command: a staircase of 0.2, 0.4, 0.8, 1.6 and 4 V to both sides, 0.4 s each",
                   "der Befehl: eine Treppe von 0,2, 0,4, 0,8, 1,6 und 4 V nach beiden Seiten, je 0,4 s"}};
}

/// Leakages show at small openings, the Stribeck curve at low speeds, the bulk modulus over pressure at large ones.
std::vector<InputCourse> AxisCourses(const Machine& machine) {
  const auto known = machine.geometry.find("U_n");
  const double nominal = known == machine.geometry.end() ? 10.0 : known->second.value;
  InputCourse staircase{{"staircase", "Treppe"}, "U", {}, 0.4};
  for (const double level : {0.02, 0.04, 0.08, 0.16, 0.4})
    for (const double sign : {1.0, -1.0}) staircase.levels.push_back(sign * level * nominal);
  return {staircase};
}

}  // namespace

const MachineKind kFlexibleAxis = {
    .id = "flexible_axis",
    .title = {"servo axis with a flexible load", "Servoachse mit elastischer Last"},
    .signals = kAxisSignals,
    .geometry = kAxisGeometry,
    .parameters = kAxisParameters,
    .output_unit = "m",
    .has_states = true,
    .states = AxisStates,
    .words = AxisWords,
    .picture = FlexibleAxisPicture,
    .draft = {nullptr, CompleteAxis},
    .effects = FlexibleAxisEffects,
    .experiment = {.courses = AxisCourses}};

}  // namespace hydroscope
