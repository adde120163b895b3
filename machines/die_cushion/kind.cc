#include "machines/die_cushion/kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "core/units.h"
#include "machines/die_cushion/balance.h"
#include "machines/die_cushion/experiment.h"
#include "machines/die_cushion/library.h"
#include "machines/inputs.h"
#include "models/machine_draft.h"

namespace hydroscope {
namespace {

constexpr double kMoving = 0.008;  ///< m/s
constexpr double kLag = 0.05;      ///< s over which the speed is taken
constexpr int kRowsToDecide = 50;

/// What happens while the pressure is in its upper half and the cushion moves.
struct Strokes {
  int falling = 0, rising = 0;                 ///< rows
  double spool_falling = 0, spool_rising = 0;  ///< sum of y_v
};

Strokes Watch(const LogSample& log) {
  const std::vector<double>&p = log.signals.at("p_A").value, &z = log.signals.at("z").value,
        &y = log.signals.at("y_v").value;
  std::vector<double> sorted;
  for (const double value : p)
    if (std::isfinite(value)) sorted.push_back(value);
  Strokes strokes;
  if (sorted.size() < 2) return strokes;
  std::sort(sorted.begin(), sorted.end());
  const double middle = 0.5 * (sorted[sorted.size() / 100] + sorted[sorted.size() - 1 - sorted.size() / 100]);
  const auto lag = static_cast<std::size_t>(std::max(1.0, std::round(kLag / log.period)));
  for (std::size_t i = lag; i + lag < z.size(); ++i) {
    const double speed = (z[i + lag] - z[i - lag]) / (2 * static_cast<double>(lag) * log.period);
    if (!(p[i] > middle) || !(std::abs(speed) > kMoving) || !std::isfinite(y[i])) continue;
    (speed < 0 ? strokes.falling : strokes.rising) += 1;
    (speed < 0 ? strokes.spool_falling : strokes.spool_rising) += y[i];
  }
  return strokes;
}

SignalSpec& SignalOf(Machine& machine, const char* name) {
  return machine.signals[static_cast<std::size_t>(machine.SignalIndex(name))];
}

/// Turns `z` and `y_v` the model's way round: in a drawing stroke (pressure high, cushion moving) the position falls and the
/// spool is positive.
void TurnSignals(const LogSample& log, MachineDraft& draft) {
  if (!(log.period > 0)) {
    draft.decided.emplace_back(
        "directions of z and y_v were not checked: no time between rows is known",
        "Richtungen von z und y_v wurden nicht geprüft: der Zeitabstand der Zeilen ist nicht bekannt");
    return;
  }
  const Strokes strokes = Watch(log);
  if (strokes.falling + strokes.rising < kRowsToDecide) {
    draft.decided.emplace_back(
        "directions of z and y_v were not checked: no drawing stroke in the part of the log that was looked at",
        "Richtungen von z und y_v wurden nicht geprüft: kein Ziehhub in dem Teil des Logs, der angesehen wurde");
    return;
  }
  const bool turned = strokes.rising > strokes.falling;
  SignalSpec& z = SignalOf(draft.machine, "z");
  if (turned) {
    const Unit unit = FindUnit(z.unit).value_or(Unit{});
    const double end = (log.signals.at("z").high - unit.offset) / unit.scale;
    z.scale = -z.scale;
    z.offset = std::strtod(fmt::format("{:.4g}", end).c_str(), nullptr);
    draft.decided.emplace_back(
        "z rises while the pressure is high: turned round (scale -1), because the model's z falls in a stroke",
        "z steigt, während der Druck hoch ist: umgedreht (Faktor -1), weil z im Modell in einem Hub fällt");
  } else {
    draft.decided.emplace_back("z falls while the pressure is high, as the model expects",
                               "z fällt, während der Druck hoch ist, wie das Modell es erwartet");
  }
  SignalSpec& y = SignalOf(draft.machine, "y_v");
  if ((turned ? strokes.spool_rising : strokes.spool_falling) < 0) {
    y.scale = -y.scale;
    y.offset = -y.offset;
    draft.decided.emplace_back(
        "y_v is negative in the strokes: turned round (scale -1), because positive opens to tank in the model",
        "y_v ist in den Hüben negativ: umgedreht (Faktor -1), weil positiv im Modell zum Tank öffnet");
  } else {
    draft.decided.emplace_back("y_v is positive in the strokes, as the model expects",
                               "y_v ist in den Hüben positiv, wie das Modell es erwartet");
  }
}

Told Suits(const LogSample& log) {
  for (const char* needed : {"p_A", "z", "y_v"})
    if (!log.signals.contains(needed)) return {};
  return {"pressure, position and spool are there", "Druck, Position und Schieber sind da"};
}

void Complete(const LogSample& log, const std::map<std::string, double>& known, MachineDraft& draft) {
  Machine& machine = draft.machine;
  if (!Suits(log).empty()) {
    TurnSignals(log, draft);
    machine.gate.bounds = {{"y_v", false, 0.04, {}}, {"z", true, {}, -0.004}};
  }
  machine.geometry["dp_nom"] = {35e5, 0};
  machine.geometry["p_t"] = {0, 0};
  draft.decided.emplace_back(
      "dp_nom = 35 bar: the pressure drop at which the nominal flow is stated, usual for servo valves",
      "dp_nom = 35 bar: der Druckabfall, für den der Nenndurchfluss angegeben ist, üblich bei Servoventilen");
  if (!log.signals.contains("p_t"))
    draft.decided.emplace_back("p_t = 0 bar: no tank pressure in the log",
                               "p_t = 0 bar: kein Tankdruck im Log");
  if (const auto area = known.find("A_A"); area != known.end()) {
    machine.geometry["A_A"] = {area->second, 0};
    return;
  }
  draft.open.emplace_back(
      "[geometry] A_A: the piston area on side A cannot be found from a log; write it from the drawing",
      "[geometry] A_A: die Kolbenfläche auf Seite A steht in keinem Log; aus der Zeichnung eintragen");
  draft.notes.section["geometry"] = {
      "<-- FILL IN the piston area on side A from the drawing and remove the leading '# ' of the next line:",
      "A_A = { value = 125, unit = \"cm2\" }"};
}

/// A log with pressure A, position and spool is of a die cushion; its signals are turned the model's way round.
const DraftRules kCushionDraft = {Suits, Complete};

// From a pneumatic cylinder to an intensifier; a die cushion works at tens to some hundred bar. Seals allow some m/s.
constexpr double kLeastPressure = 5e5, kMostPressure = 1e8;  // Pa
constexpr double kSlowest = 1e-3, kFastest = 20;             // m/s
constexpr PlausibleSize kAnyPressure{0, kMostPressure};

constexpr std::array<MachineInput, 8> kCushionSignals = {{
    Measured("p_A", "Pa", {"pressure in the cylinder chamber A", "Druck in der Zylinderkammer A"},
             PlausibleSize{kLeastPressure, kMostPressure}),
    Measured("z", "m", {"position of the cushion", "Position des Ziehkissens"},
             PlausibleSize{1e-3, 10.0, PlausibleSize::kTravel}),
    Measured("y_v", "1", {"spool position, -1 to 1", "Schieberstellung, -1 bis 1"}, PlausibleSize{0, 1.5}),
    MayBeMeasured("p_B", "Pa", {"pressure in chamber B", "Druck in Kammer B"}, kAnyPressure),
    MayBeMeasured("p_0", "Pa", {"supply pressure", "Versorgungsdruck"}, kAnyPressure),
    MayBeMeasured("p_t", "Pa", {"tank pressure", "Tankdruck"}, kAnyPressure),
    MayBeMeasured("U_v", "V", {"valve command", "Ventilbefehl"}),
    MayBeMeasured("T_oil", "K", {"oil temperature", "Öltemperatur"}),
}};
constexpr std::array<MachineInput, 4> kCushionGeometry = {{
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
     .positive = true},
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
        Identified(
            "Q_vn", "m3/s", {"nominal valve flow", "Nenndurchfluss des Ventils"},
            {"Flow through the fully open valve at its nominal pressure drop; it moves with the oil's viscosity "
             "and density, with worn or dirty metering edges, and it absorbs leaks that the model does not hold.",
             "Durchfluss des ganz offenen Ventils bei seinem Nenndruckabfall; er ändert sich mit Zähigkeit und Dichte des Öls, mit verschlissenen oder verschmutzten Steuerkanten, und er nimmt Leckagen auf, die das Modell nicht enthält."},
            "Q_{vn}")),
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
    {.signal = "y_v", .command = "U_v", .full_command = 10.0, .at_stop = 0.97},
    // The cushion goes down and up while the spool opens both ways: oil leaves the chamber and enters it.
    {.signal = "p_A",
     .movements = {{"y_v", false, kOpen, {}},
                   {"y_v", false, {}, -kOpen},
                   {"z", true, {}, -kGoes},
                   {"z", true, kGoes, {}}}},
}};

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
                                 .draft = kCushionDraft,
                                 .build = BuildDieCushion,
                                 .effects = CushionEffects,
                                 .channels = kCushionChannels,
                                 .experiment = kCushionExperiment};

}  // namespace hydroscope
