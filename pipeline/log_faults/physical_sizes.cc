#include "pipeline/log_faults/physical_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constants.h"
#include "core/told_error.h"
#include "core/units.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "pipeline/raw_log.h"

namespace hydroscope {
namespace {

constexpr std::size_t kPiece = 16;           ///< rows in a mean
constexpr std::size_t kRowsPerLook = 16384;  ///< of a log between two judgements
/// Share of the readings beyond which the range of a signal is looked at: bursts of wrong readings are no unit.
constexpr double kOutside = 0.01;
/// Mean step between means over the range: white noise has a quarter, a stroke of a second some percent.
constexpr double kRestless = 0.12;

/// The largest pumps of presses deliver some thousand l/min (m3/s), ...
constexpr double kMostFlow = 0.5;
/// ... and whatever drives a valve or a motor of a machine stays below these.
constexpr double kMostVolts = 2e3, kMostAmperes = 2e3;
/// Pa. Cavitating oil is at a vacuum, and so is a line that runs dry; the zero of a sensor for hundreds of bar is off by less.
constexpr double kBelowVacuum = 10e5;
/// Of the stroke that the machine file states: a sensor may reach, and a piston go, somewhat farther.
constexpr double kMostOfStroke = 1.5;
/// m/s, of a machine that works: at such a speed its valve is open.
constexpr double kWorks = 0.02;

/// What every machine keeps to: pressures of an intensifier at most, strokes of cylinders end at some ten metres, oil
/// solidifies and burns.
std::optional<PlausibleSize> SizeByUnit(std::string_view si) {
  if (si == "Pa") return PlausibleSize{0, 1e9};
  if (si == "m") return PlausibleSize{0, 50.0, PlausibleSize::kTravel};
  if (si == "K") return PlausibleSize{213, 573, PlausibleSize::kMean};
  if (si == "m3/s") return PlausibleSize{0, kMostFlow};
  if (si == "V") return PlausibleSize{0, kMostVolts};
  if (si == "A") return PlausibleSize{0, kMostAmperes};
  return std::nullopt;
}

std::optional<PlausibleSize> SizeOf(const Machine& machine, const SignalSpec& spec, std::string_view si) {
  for (const MachineInput& signal : KindOf(machine).signals)
    if (signal.name == spec.name && signal.size) return signal.size;
  return SizeByUnit(si);
}

/// In which a signal of an SI unit comes.
std::vector<const char*> UsualUnits(std::string_view si) {
  if (si == "Pa") return {"Pa", "bar", "MPa", "kPa", "psi", "mbar"};
  if (si == "m") return {"mm", "m", "cm", "um"};
  if (si == "K") return {"degC", "K", "degF"};
  if (si == "m3/s") return {"l/min", "m3/s", "m3/h"};
  if (si == "rad/s") return {"rpm", "rad/s"};
  if (si == "rad") return {"deg", "rad"};
  if (si == "V") return {"V", "mV"};
  if (si == "A") return {"mA", "A"};
  return {"1", "%"};
}

/// Whether the heading of the column ends with the unit that the machine file states: "T_oil [°C]", "T_oil_degC", "T_oil_C".
bool HeadingSays(const std::string& column, const Unit& unit) {
  const std::size_t end = column.find_last_not_of(" ])");
  const std::size_t before = column.find_last_of(" _-.[(", end);
  if (end == std::string::npos || before == std::string::npos) return false;
  const std::string word = column.substr(before + 1, end - before);
  const auto said = FindUnit(word == "C" || word == "Celsius" ? "degC" : word);
  return said && said->si == unit.si && said->scale == unit.scale && said->offset == unit.offset;
}

Told Shown(double si, const Unit& unit, std::string_view name) {
  const double value = (si - unit.offset) / unit.scale;
  return name == "1" ? Tell("{:.4g}", "{:.4g}", value) : Tell("{:.4g} {}", "{:.4g} {}", value, name);
}

}  // namespace

struct SizeWatch::Range {
  double low = kNaN, high = kNaN, mean = kNaN;
  bool moves = false;  ///< smoothly, more than noise makes of a signal at rest

  double Measure(const PlausibleSize& by) const {
    if (by.of == PlausibleSize::kTravel) return high - low;
    return by.of == PlausibleSize::kMean ? mean : std::max(std::abs(low), std::abs(high));
  }
};

SizeWatch::SizeWatch(const Machine& machine, double sample_period)
    : machine_(machine),
      piece_time_(sample_period * kPiece),
      sum_(machine.signals.size(), 0.0),
      means_(machine.signals.size()) {}

void SizeWatch::Observe(const SampleBlock& block) {
  for (std::size_t row = 0; row < block.rows(); ++row) {
    for (std::size_t s = 0; s < sum_.size(); ++s) sum_[s] += block.signal[s][row];
    if (++rows_ < kPiece) continue;
    for (std::size_t s = 0; s < sum_.size(); ++s) {
      means_[s].push_back(sum_[s] / kPiece);
      sum_[s] = 0;
    }
    rows_ = 0;
  }
}

SizeWatch::Range SizeWatch::Seen(std::size_t signal) const {
  std::vector<double> known;
  double sum = 0;
  for (const double mean : means_[signal])
    if (std::isfinite(mean)) known.push_back(mean), sum += mean;
  if (known.empty()) return {};
  const auto at = [&](double share) {
    const auto k = static_cast<std::ptrdiff_t>(share * static_cast<double>(known.size() - 1));
    std::nth_element(known.begin(), known.begin() + k, known.end());
    return known[k];
  };
  double steps = 0;
  for (std::size_t k = 1; k < means_[signal].size(); ++k) {
    const double step = std::abs(means_[signal][k] - means_[signal][k - 1]);
    if (std::isfinite(step)) steps += step;
  }
  Range out{at(kOutside), at(1 - kOutside), sum / static_cast<double>(known.size())};
  out.moves = steps < kRestless * (out.high - out.low) * static_cast<double>(known.size());
  return out;
}

Status SizeWatch::JudgeSignal(std::size_t signal) const {
  const SignalSpec& spec = machine_.signals[signal];
  const auto unit = FindUnit(spec.unit);
  if (!unit) return {};
  const auto plausible = SizeOf(machine_, spec, unit->si);
  const Range seen = Seen(signal);
  if (!plausible || std::isnan(seen.low)) return {};
  const double measure = seen.Measure(*plausible);
  if (measure >= plausible->low && measure <= plausible->high) return {};
  // Hot oil in a column that says its unit is hot oil.
  if (plausible->of == PlausibleSize::kMean && HeadingSays(spec.column, *unit)) {
    const auto any = SizeByUnit(unit->si);
    if (!any || (measure >= any->low && measure <= any->high)) return {};
  }
  // A machine at rest shows little of anything; a loop whose set point is excited does not rest.
  const auto excited = [&] {
    const ClosedLoopPlant* const loop = ClosedLoopOf(machine_);
    const int at = loop != nullptr ? machine_.SignalIndex(std::string(loop->set_point)) : -1;
    if (at < 0) return false;
    const SignalSpec& set_point = machine_.signals[static_cast<std::size_t>(at)];
    const auto its_unit = FindUnit(set_point.unit);
    const auto size = its_unit ? SizeOf(machine_, set_point, its_unit->si) : std::nullopt;
    return size && Seen(static_cast<std::size_t>(at)).Measure(*size) >= size->low;
  };
  if (measure < plausible->low && plausible->of != PlausibleSize::kMean && !seen.moves && !excited())
    return {};
  std::string better;
  for (const char* name : UsualUnits(unit->si)) {
    const auto other = FindUnit(name);
    if (!other || name == spec.unit || !better.empty()) continue;
    const auto in_other = [&](double si) {
      return (si - unit->offset) / unit->scale * other->scale + other->offset;
    };
    const double size =
        Range{in_other(seen.low), in_other(seen.high), in_other(seen.mean)}.Measure(*plausible);
    if (size > 0 && size >= plausible->low && size <= plausible->high) better = name;
  }
  // A share that stays small is what it may be, but for one that another unit makes larger while the machine works.
  if (measure < plausible->low && unit->si == "1" && (better.empty() || !Works())) return {};
  // A sensor of an optional signal that is broken stops nothing; a wrong unit does.
  if (!spec.required && better.empty()) return {};
  Unit scale = *unit;
  if (plausible->of != PlausibleSize::kMean) scale.offset = 0;  // of a difference
  const auto shown = [&](double si) { return Shown(si, scale, spec.unit); };
  const Told what = plausible->of == PlausibleSize::kTravel ? Told("travels by", "bewegt sich um")
                    : plausible->of == PlausibleSize::kMean ? Told("is at", "liegt bei")
                                                            : Told("reaches", "erreicht");
  const Told advice =
      better.empty()
          ? Tell("Check unit, scale and offset of [signals] {} in the machine file",
                 "unit, scale und offset von [signals] {} in der Maschinendatei prüfen", spec.name)
          : Tell(
                "Its numbers look like {0}: set unit = \"{0}\" for {1} in [signals] of the machine file",
                "Die Zahlen sehen nach {0} aus: in [signals] der Maschinendatei unit = \"{0}\" für {1} setzen",
                better, spec.name);
  return BadInput(
      Tell("{}: signal {} (column {}) {} {}, which no such machine does; plausible: {} to {}. {}",
           "{}: Signal {} (Spalte {}) {} {}, was keine solche Maschine tut; plausibel: {} bis {}. {}",
           machine_.name, spec.name, spec.column, what, shown(measure), shown(plausible->low),
           shown(plausible->high), advice));
}

/// A pressure of the machine that lies as far below zero as no pressure does. One of an optional signal is told of by the pass over
/// the log where it lies outside of what the machine file declares, since nothing is made of it then.
Status SizeWatch::JudgeSign(std::size_t signal) const {
  const SignalSpec& spec = machine_.signals[signal];
  const auto unit = FindUnit(spec.unit);
  const bool of_kind = std::ranges::any_of(KindOf(machine_).signals, [&](const MachineInput& input) {
    return input.name == spec.name && input.si == "Pa" && input.size.has_value();
  });
  if (!unit || !of_kind) return {};
  const Range seen = Seen(signal);
  if (!(seen.low < -kBelowVacuum) || !(-seen.low > seen.high)) return {};
  if (!spec.required && seen.high < spec.min.value_or(seen.high)) return {};
  return BadInput(Tell(
      "{}: signal {} (column {}) goes from {} to {}, and no pressure is below a vacuum: it counts the other way round, or its zero is "
      "off. Set scale = -1, or the offset, for {} in [signals] of the machine file",
      "{}: Signal {} (Spalte {}) geht von {} bis {}, und kein Druck liegt unter Vakuum: es zählt andersherum, oder sein Nullpunkt "
      "stimmt nicht. In [signals] der Maschinendatei für {} scale = -1 oder den offset setzen",
      machine_.name, spec.name, spec.column, Shown(seen.low, *unit, spec.unit),
      Shown(seen.high, *unit, spec.unit), spec.name));
}

/// Whether a signal travels farther than a length of [geometry] lets it.
Status SizeWatch::JudgeTravel(const MachineInput& length) const {
  const auto known = machine_.Geometry(std::string(length.name));
  const int signal = machine_.SignalIndex(std::string(length.travel_of));
  if (!known || signal < 0) return {};
  const Range seen = Seen(static_cast<std::size_t>(signal));
  if (!(seen.high - seen.low > kMostOfStroke * known->value)) return {};
  const SignalSpec& spec = machine_.signals[static_cast<std::size_t>(signal)];
  Unit unit = FindUnit(spec.unit).value_or(Unit{});
  unit.offset = 0;
  return BadInput(Tell(
      "{0}: signal {1} (column {2}) travels by {3}, farther than {4} = {5} in [geometry] of the machine file: "
      "check unit and scale of {1}, and {4}",
      "{0}: Signal {1} (Spalte {2}) bewegt sich um {3}, weiter als {4} = {5} in [geometry] der Maschinendatei: Einheit und Skalierung "
      "von {1} prüfen, und {4}",
      machine_.name, spec.name, spec.column, Shown(seen.high - seen.low, unit, spec.unit), length.name,
      Shown(known->value, unit, spec.unit)));
}

/// The fastest that a position moves, m/s or rad/s; nothing of too few rows.
std::optional<double> SizeWatch::TopSpeed(std::size_t signal) const {
  const std::vector<double>& z = means_[signal];
  std::vector<double> speeds;
  for (std::size_t k = 1; k < z.size(); ++k)
    if (std::isfinite(z[k] - z[k - 1])) speeds.push_back(std::abs(z[k] - z[k - 1]) / piece_time_);
  if (speeds.size() < 100) return std::nullopt;
  const auto top =
      speeds.begin() + static_cast<std::ptrdiff_t>((1 - kOutside) * static_cast<double>(speeds.size()));
  std::nth_element(speeds.begin(), top, speeds.end());
  return *top;
}

bool SizeWatch::Works() const {
  return std::ranges::any_of(KindOf(machine_).conditions, [&](const Condition& condition) {
    const int signal = machine_.SignalIndex(condition.signal);
    return condition.of == Condition::Of::kMeanRate && condition.unit == "m/s" && signal >= 0 &&
           TopSpeed(static_cast<std::size_t>(signal)).value_or(0) > kWorks;
  });
}

/// The speed of a position says whether the time is in the unit that the machine file states.
Status SizeWatch::JudgeSpeed(const Condition& speed, std::size_t signal) const {
  const std::optional<double> top = TopSpeed(signal);
  if (!top) return {};
  if (*top >= speed.lowest && *top <= speed.highest) return {};
  if (*top < speed.lowest && !Seen(signal).moves) return {};
  const DisplayUnit unit = DisplayUnitFor(speed.unit);
  return BadInput(Tell(
      "{}: signal {} moves at {:.3g} {} at most, which no such machine does; plausible: {:g} to {:g} {}. "
      "Rows are {:.4g} s apart with the time in {}: check the unit of time (or sample_period) in [log] of "
      "the machine file, and the unit of {}",
      "{}: Signal {} bewegt sich mit höchstens {:.3g} {}, was keine solche Maschine tut; plausibel: {:g} bis {:g} {}. "
      "Die Zeilen liegen {:.4g} s auseinander, die Zeit in {}: die Einheit der Zeit (oder sample_period) in [log] der "
      "Maschinendatei prüfen, und die Einheit von {}",
      machine_.name, speed.signal, *top * unit.factor, unit.name, speed.lowest * unit.factor,
      speed.highest * unit.factor, unit.name, piece_time_ / kPiece, machine_.log.time_unit, speed.signal));
}

Status SizeWatch::Judge() const {
  for (std::size_t s = 0; s < machine_.signals.size(); ++s) {
    TRY(JudgeSignal(s));
    TRY(JudgeSign(s));
  }
  for (const MachineInput& length : KindOf(machine_).geometry)
    if (!length.travel_of.empty()) TRY(JudgeTravel(length));
  for (const Condition& condition : KindOf(machine_).conditions) {
    const int signal = machine_.SignalIndex(condition.signal);
    const bool limited = condition.highest > condition.lowest && condition.of == Condition::Of::kMeanRate;
    if (!limited || signal < 0) continue;
    TRY(JudgeSpeed(condition, static_cast<std::size_t>(signal)));
  }
  return {};
}

Status JudgeGeometry(const Machine& machine) {
  for (const MachineInput& value : KindOf(machine).geometry) {
    const auto known = machine.Geometry(std::string(value.name));
    const bool any = !(value.highest > value.lowest);
    if (!known || any || (known->value >= value.lowest && known->value <= value.highest)) continue;
    const Unit unit = FindUnit(value.unit).value_or(Unit{});
    return BadInput(Tell(
        "{0}: {1} = {2} is no {3} of such a machine; plausible: {4} to {5}. Check value and unit of {1} in "
        "[geometry] of the machine file",
        "{0}: {1} = {2} ist keine solche Größe ({3}) einer solchen Maschine; plausibel: {4} bis {5}. Wert und Einheit "
        "von {1} in [geometry] der Maschinendatei prüfen",
        machine.name, value.name, Shown(known->value, unit, value.unit), value.meaning,
        Shown(value.lowest, unit, value.unit), Shown(value.highest, unit, value.unit)));
  }
  return {};
}

Status JudgeSizes(const std::string& log, const Machine& machine) {
  TRY(JudgeGeometry(machine));
  auto reader = TRY(OpenRecording(log, machine));
  SizeWatch watch(machine, reader->SamplePeriod());
  SampleBlock block;
  Status seen;
  for (;;) {
    const auto rows = reader->Read(block, kRowsPerLook);
    if (!rows || *rows == 0) break;  // what stops the reading is told by the pass that follows
    watch.Observe(block);
    seen = watch.Judge();
    if (seen) return {};
  }
  if (!seen) return BadInput(Tell("{}: {}", "{}: {}", log, ToldOf(seen.error())));
  return {};
}

Status JudgeStrokes(const std::string& database, const Machine& machine,
                    std::span<const StrokeSummary> strokes) {
  TRY(JudgeGeometry(machine));
  const std::vector<Condition> conditions = ConditionsOf(machine);
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const Condition& condition = conditions[c];
    double most = 0;
    for (const StrokeSummary& stroke : strokes) most = std::max(most, stroke.conditions[c]);
    const bool limited = condition.highest > condition.lowest;
    if (!limited || !(most > 0) || (most >= condition.lowest && most <= condition.highest)) continue;
    const DisplayUnit unit = DisplayUnitFor(condition.unit);
    return BadInput(Tell(
        "{}: {}: the {} is {:.4g} {}, which no such machine has; plausible: {:g} to {:g} {}. They were "
        "replayed with a wrong unit of {} or of the time: correct the machine "
        "file and replay into a new database",
        "{0}: {1}: {2} ist {3:.4g} {4}, was keine solche Maschine hat; plausibel: {5:g} bis {6:g} {7}. Mit falscher "
        "Einheit von {8} oder der Zeit eingespielt: die Maschinendatei berichtigen und in eine neue Datenbank "
        "einspielen",
        database, machine.name, condition.title.english, most * unit.factor, unit.name,
        condition.lowest * unit.factor, condition.highest * unit.factor, unit.name, condition.signal));
  }
  return {};
}

}  // namespace hydroscope
