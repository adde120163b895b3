#include "machines/die_cushion/draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/units.h"
#include "models/pressure_rule.h"

namespace hydroscope {
namespace {

constexpr double kMoving = 0.008;  ///< m/s
constexpr double kLag = 0.05;      ///< s over which the speed is taken
constexpr int kRowsToDecide = 50;
/// Share of these rows in which the cushion moves one way, and of the spool's opening that is to one side: under pressure the ram pushes
/// it down, and a log in which it goes both ways alike is none of strokes.
constexpr double kOneWay = 0.7;

/// What happens while the pressure is in its upper half and the cushion moves.
struct Strokes {
  int falling = 0, rising = 0;                     ///< rows
  double spool_falling = 0, spool_rising = 0;      ///< sum of y_v
  double opening_falling = 0, opening_rising = 0;  ///< sum of its magnitude

  bool GoOneWay() const { return std::max(falling, rising) > kOneWay * (falling + rising); }
  bool OpenOneWay() const {
    const bool rise = rising > falling;
    return std::abs(rise ? spool_rising : spool_falling) >
           (2 * kOneWay - 1) * (rise ? opening_rising : opening_falling);
  }
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
    (speed < 0 ? strokes.opening_falling : strokes.opening_rising) += std::abs(y[i]);
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
  if (!strokes.GoOneWay() || !strokes.OpenOneWay()) {
    draft.open.push_back(Tell(
        "[signals] z, y_v: {} while the pressure is high, so that which way round they count cannot be told, and no drawing stroke "
        "is seen. Look whether these columns are what their names say; the model's z falls in a stroke, and positive "
        "y_v opens to tank",
        "[signals] z, y_v: {}, während der Druck hoch ist; wie herum sie zählen, ist so nicht zu sehen, auch kein Ziehhub. "
        "Nachsehen, ob diese Spalten sind, was ihr Name sagt; im Modell fällt z in einem Hub, und positives y_v öffnet zum Tank",
        strokes.GoOneWay() ? Told("the spool opens both ways", "der Schieber öffnet nach beiden Seiten")
                           : Told("z goes both ways", "z bewegt sich in beide Richtungen")));
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

/// Names of columns are taken at their word, but no chamber stands above its supply all the time.
void CheckSupply(const LogSample& log, MachineDraft& draft) {
  const auto chamber = log.signals.find("p_B"), supply = log.signals.find("p_0");
  if (chamber == log.signals.end() || supply == log.signals.end()) return;
  const std::vector<double>&b = chamber->second.value, &p = supply->second.value;
  int rows = 0, above = 0;
  for (std::size_t i = 0; i < std::min(b.size(), p.size()); ++i) {
    rows += std::isfinite(b[i]) && std::isfinite(p[i]);
    above += b[i] > p[i];
  }
  if (rows < kRowsToDecide || above < PressureRule::kNearlyAlways * rows) return;
  draft.decided.emplace_back(
      "p_B stands above p_0 all the time, which no chamber does: look whether the two columns are swapped",
      "p_B liegt die ganze Zeit über p_0, was keine Kammer tut: nachsehen, ob die beiden Spalten vertauscht sind");
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
  CheckSupply(log, draft);
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

}  // namespace

const DraftRules kCushionDraft = {Suits, Complete};

}  // namespace hydroscope
