#include "machines/die_cushion/kind.h"

#include <array>

#include "machines/die_cushion/balance.h"
#include "machines/die_cushion/draft.h"
#include "machines/die_cushion/experiment.h"
#include "machines/die_cushion/library.h"
#include "machines/inputs.h"

namespace hydroscope {
namespace {

// From a pneumatic cylinder to an intensifier; a die cushion works at tens to some hundred bar. Seals allow some m/s.
constexpr double kLeastPressure = 5e5, kMostPressure = 1e8;  // Pa
constexpr double kSlowest = 1e-3, kFastest = 20;             // m/s
constexpr PlausibleSize kAnyPressure{0, kMostPressure};
constexpr PlausibleSize kAnySpool{0.02, 1.5};                          // a valve works beyond its overlap
constexpr PlausibleSize kOilOfAPress{248, 363, PlausibleSize::kMean};  // K, over a log

constexpr std::array<MachineInput, 8> kCushionSignals = {{
    Measured("p_A", "Pa", {"pressure in the cylinder chamber A", "Druck in der Zylinderkammer A"},
             PlausibleSize{kLeastPressure, kMostPressure}),
    Measured("z", "m", {"position of the cushion", "Position des Ziehkissens"},
             PlausibleSize{1e-3, 10.0, PlausibleSize::kTravel}),
    Measured("y_v", "1", {"spool position, -1 to 1", "Schieberstellung, -1 bis 1"}, kAnySpool),
    MayBeMeasured("p_B", "Pa", {"pressure in chamber B", "Druck in Kammer B"}, kAnyPressure),
    MayBeMeasured("p_0", "Pa", {"supply pressure", "Versorgungsdruck"}, kAnyPressure),
    MayBeMeasured("p_t", "Pa", {"tank pressure", "Tankdruck"}, kAnyPressure),
    MayBeMeasured("U_v", "V", {"valve command", "Ventilbefehl"}),
    MayBeMeasured("T_oil", "K", {"oil temperature", "Öltemperatur"}, kOilOfAPress),
}};
constexpr std::array<MachineInput, 5> kCushionGeometry = {{
    {.name = "A_A",
     .si = "m2",
     .required = true,
     .meaning = {"piston area on side A", "Kolbenfläche auf Seite A"},
     .positive = true,
     .lowest = 1e-4,
     .highest = 1.0,
     .unit = "cm2",
     .shared_by = "V0 and Q_vn"},
    // Valves state their flow at 1 bar (cartridges) to 350 bar.
    Known("dp_nom", "Pa",
          {"pressure drop at which the valve's nominal flow is stated",
           "Druckabfall, für den der Nenndurchfluss des Ventils angegeben ist"},
          1e5, 350e5, "bar"),
    TankPressure(),
    {.name = "stroke",
     .si = "m",
     .required = false,
     .meaning = {"working stroke of the cushion", "Arbeitshub des Ziehkissens"},
     .positive = true,
     .travel_of = "z"},
    {.name = "Q_nom",
     .si = "m3/s",
     .required = false,
     .meaning = {"nominal flow of the valve by its data sheet", "Nenndurchfluss des Ventils laut Datenblatt"},
     .positive = true,
     .lowest = 1e-6,
     .highest = 0.1,
     .unit = "l/min"},
}};
constexpr std::array<MachineParameter, 4> kCushionParameters = {{
    Identified(
        "K", "Pa", {"effective bulk modulus", "wirksamer Kompressionsmodul"},
        {"How stiff the oil column is, hoses and cylinder walls included; it falls when air enters the oil.",
         "Wie steif die Ölsäule samt Schläuchen und Zylinderwänden ist; er fällt, wenn Luft ins Öl kommt."},
        "K′"),
    OverOil(
        OilLaw::kNone,
        Identified(
            "V0", "m3", {"dead volume", "Totvolumen"},
            {"Oil volume between valve and piston with the piston at its zero position: "
             "lines, fittings, bottom of the chamber.",
             "Ölvolumen zwischen Ventil und Kolben, mit dem Kolben in seiner Nullstellung: Leitungen, Verschraubungen, Boden der Kammer."},
            "V_{0}")),
    OverOil(
        OilLaw::kViscosity,
        StatedAs(
            "Q_nom",
            Identified(
                "Q_vn", "m3/s", {"nominal valve flow", "Nenndurchfluss des Ventils"},
                {"Flow through the fully open valve at its nominal pressure drop; it moves with the oil's viscosity "
                 "and density, with worn or dirty metering edges, and it absorbs leaks that the model does not hold.",
                 "Durchfluss des ganz offenen Ventils bei seinem Nenndruckabfall; er ändert sich mit Zähigkeit und Dichte des Öls, mit verschlissenen oder verschmutzten Steuerkanten, und er nimmt Leckagen auf, die das Modell nicht enthält."},
                "Q_{vn}"))),
    {.name = "y_0",
     .si = "1",
     .meaning = {"spool null", "Nullpunkt des Schiebers"},
     .symbol = "y_{0}",
     .sentence =
         {"Spool position at which the metering edge just closes, in % of the full spool stroke; it "
          "moves with wear of the edge and with the zero of the spool sensor.",
          "Schieberstellung, bei der die Steuerkante gerade schließt, in % des ganzen Schieberwegs; sie ändert sich mit dem Verschleiß der Kante und mit dem Nullpunkt des Schiebersensors."},
     .shown = "% of stroke",
     .factor = 100,
     .relative = false,
     .over_oil = OilLaw::kNone},
}};
const std::array<Condition, 3> kCushionConditions = {{
    {.name = "speed",
     .title = {"mean speed of the strokes", "mittlere Geschwindigkeit der Hübe"},
     .signal = "z",
     .of = Condition::Of::kMeanRate,
     .unit = "m/s",
     .least = 1e-4,
     .lowest = kSlowest,
     .highest = kFastest,
     .vary = {"ram speed", "die Stößelgeschwindigkeit"},
     .hides = {"at one speed a leak looks like more or less valve flow",
               "bei einer Geschwindigkeit sieht ein Leck aus wie mehr oder weniger Durchfluss des Ventils"}},
    {.name = "pressure",
     .title = {"mean pressure of the strokes", "mittlerer Druck der Hübe"},
     .signal = "p_A",
     .of = Condition::Of::kMean,
     .unit = "Pa",
     .least = 1e4,
     .lowest = kLeastPressure,
     .highest = kMostPressure,
     .vary = {"the cushion force", "die Kissenkraft"}},
    {.name = "max_pressure",
     .title = {"highest pressure of the strokes", "höchster Druck der Hübe"},
     .signal = "p_A",
     .of = Condition::Of::kLargest,
     .unit = "Pa",
     .least = 1e4},
}};

constexpr double kOpen = 0.05;  // of the spool, either way: beyond any overlap
constexpr double kGoes = 0.01;  // m/s

const std::array<StandstillRule, 2> kCushionStandstill = {{
    {.signal = "y_v", .command = "U_v", .full_command = 10.0, .at_stop = 0.97, .end = 1.0},
    // The cushion goes down and up while the spool opens both ways: oil leaves the chamber and enters it.
    {.signal = "p_A",
     .movements = {{"y_v", false, kOpen, {}},
                   {"y_v", false, {}, -kOpen},
                   {"z", true, {}, -kGoes},
                   {"z", true, kGoes, {}}}},
}};

// Both chambers are filled from the supply, and in a stroke the ram presses the oil out of chamber A.
const std::array<PressureRule, 3> kCushionPressures = {{
    {.lower = "p_B", .higher = "p_0"},
    {.lower = "p_A", .higher = "p_0", .law = PressureRule::Law::kFilled, .driven_by = "y_v", .open = kOpen},
    {.lower = "p_B",
     .higher = "p_A",
     .law = PressureRule::Law::kPressedOut,
     .driven_by = "y_v",
     .open = kOpen},
}};

/// Which edge is open, and so which pressure drives the flow, is known only off the valve's null, which may lie some per cent
/// beside zero; without the supply pressure only that of the edge to the tank is.
std::vector<GateBound> CushionGate(const Machine& machine) {
  constexpr double kOffNull = 0.02;
  return {{"y_v", false, kOffNull, {}, machine.SignalIndex("p_0") >= 0}};
}

MachineWords CushionWords(const Machine&) {
  return {.output = {"flow", "Durchfluss"},
          .stroke = {"drawing stroke", "Ziehhub"},
          .vary = {"ram speed and pressure", "Stößelgeschwindigkeit und Druck"},
          .sign = {"whether oil is missing or in surplus", "ob Öl fehlt oder zu viel ist"},
          .hydraulic = true};
}

std::vector<std::shared_ptr<const Effect>> CushionEffects(const Machine& machine) {
  return DieCushionEffects(CushionGeometryOf(machine));
}

}  // namespace

const MachineKind kDieCushion = {.id = "die_cushion",
                                 .title = {"die cushion", "Ziehkissen"},
                                 .signals = kCushionSignals,
                                 .geometry = kCushionGeometry,
                                 .parameters = kCushionParameters,
                                 .output_unit = "m3/s",
                                 .words = CushionWords,
                                 .picture = CushionPicture,
                                 .temperature = "T_oil",
                                 .supply = "p_0",
                                 .conditions = kCushionConditions,
                                 .standstill = kCushionStandstill,
                                 .pressures = kCushionPressures,
                                 .draft = kCushionDraft,
                                 .build = BuildDieCushion,
                                 .effects = CushionEffects,
                                 .gate = CushionGate,
                                 .channels = kCushionChannels,
                                 .experiment = kCushionExperiment};

}  // namespace hydroscope
