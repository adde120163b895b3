#include "setup/cushion_direction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace hydroscope {
namespace {

constexpr double kMoving = 0.008;  ///< m/s
constexpr double kLag = 0.05;      ///< s over which the speed is taken
constexpr int kRowsToDecide = 50;

/// A signal of the machine in SI, as the machine file describes it now.
std::vector<double> InSi(const LogColumns& head, const Machine& machine, const std::string& name) {
  const SignalSpec& spec = machine.signals[static_cast<std::size_t>(machine.SignalIndex(name))];
  const Unit unit = FindUnit(spec.unit).value_or(Unit{});
  std::vector<double> values = head.columns[head.layout.Find(spec.column).value_or(0)].value;
  for (double& value : values) value = (value * spec.scale + spec.offset) * unit.scale + unit.offset;
  return values;
}

/// What happens while the pressure is in its upper half and the cushion moves.
struct Strokes {
  int falling = 0, rising = 0;                 ///< rows
  double spool_falling = 0, spool_rising = 0;  ///< sum of y_v
};

Strokes Watch(const LogColumns& head, double seconds, const Machine& machine) {
  const std::vector<double> p = InSi(head, machine, "p_A"), z = InSi(head, machine, "z"),
                            y = InSi(head, machine, "y_v");
  std::vector<double> sorted;
  for (const double value : p)
    if (std::isfinite(value)) sorted.push_back(value);
  Strokes strokes;
  if (sorted.size() < 2) return strokes;
  std::sort(sorted.begin(), sorted.end());
  const double middle = 0.5 * (sorted[sorted.size() / 100] + sorted[sorted.size() - 1 - sorted.size() / 100]);
  const auto lag = static_cast<std::size_t>(std::max(1.0, std::round(kLag / seconds)));
  for (std::size_t i = lag; i + lag < z.size(); ++i) {
    const double speed = (z[i + lag] - z[i - lag]) / (2 * static_cast<double>(lag) * seconds);
    if (!(p[i] > middle) || !(std::abs(speed) > kMoving) || !std::isfinite(y[i])) continue;
    (speed < 0 ? strokes.falling : strokes.rising) += 1;
    (speed < 0 ? strokes.spool_falling : strokes.spool_rising) += y[i];
  }
  return strokes;
}

}  // namespace

std::vector<std::string> TurnCushionSignals(const LogColumns& head, double seconds, Machine& machine) {
  if (!(seconds > 0)) return {"directions of z and y_v were not checked: no time between rows is known"};
  const Strokes strokes = Watch(head, seconds, machine);
  if (strokes.falling + strokes.rising < kRowsToDecide)
    return {
        "directions of z and y_v were not checked: no drawing stroke in the part of the log that was looked "
        "at"};
  std::vector<std::string> found;
  const bool turned = strokes.rising > strokes.falling;
  SignalSpec& z = machine.signals[static_cast<std::size_t>(machine.SignalIndex("z"))];
  if (turned) {
    const double end = head.columns[head.layout.Find(z.column).value_or(0)].high;
    z.scale = -z.scale;
    z.offset = std::strtod(fmt::format("{:.4g}", end).c_str(), nullptr);
    found.push_back(
        "z rises while the pressure is high: turned round (scale -1), because the model's z falls in a "
        "stroke");
  } else {
    found.emplace_back("z falls while the pressure is high, as the model expects");
  }
  const double spool = turned ? strokes.spool_rising : strokes.spool_falling;
  SignalSpec& y = machine.signals[static_cast<std::size_t>(machine.SignalIndex("y_v"))];
  if (spool < 0) {
    y.scale = -y.scale;
    y.offset = -y.offset;
    found.push_back(
        "y_v is negative in the strokes: turned round (scale -1), because positive opens to tank in the "
        "model");
  } else {
    found.emplace_back("y_v is positive in the strokes, as the model expects");
  }
  return found;
}

}  // namespace hydroscope
