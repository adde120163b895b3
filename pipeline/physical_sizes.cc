#include "pipeline/physical_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/constants.h"
#include "core/units.h"
#include "models/machine_kind.h"
#include "pipeline/raw_log.h"

namespace hydroscope {
namespace {

constexpr std::size_t kPiece = 16;           ///< rows in a mean
constexpr std::size_t kRowsPerLook = 16384;  ///< of a log between two judgements
/// Share of the readings beyond which the range of a signal is looked at: bursts of wrong readings are no
/// unit.
constexpr double kOutside = 0.01;
/// Mean step between means over the range: white noise has a quarter, a stroke of a second some percent.
constexpr double kRestless = 0.12;

/// Plausible size of a signal, SI. Pressures: from a pneumatic cylinder to an intensifier; a die cushion
/// works at tens to some hundred bar. Strokes of cylinders end at some ten metres, die cushions at less than
/// one. Oil solidifies and burns. Speeds: seals allow some m/s.
struct Plausible {
  double low, high;  ///< SI; of the largest magnitude, the travel or the mean
  enum Measure { kLargest, kTravel, kMean } measure;
  std::vector<const char*> units;  ///< in which such a signal comes
};

std::optional<Plausible> PlausibleFor(const Machine& machine, const SignalSpec& spec, std::string_view si) {
  const bool cushion = machine.model == "die_cushion";
  if (spec.name == "y_v" && cushion) return Plausible{0, 1.5, Plausible::kLargest, {"1", "%"}};
  if (si == "Pa") {
    const double low = cushion && spec.name == "p_A" ? 5e5 : 0;
    return Plausible{
        low, cushion ? 1e8 : 1e9, Plausible::kLargest, {"Pa", "bar", "MPa", "kPa", "psi", "mbar"}};
  }
  if (si == "m")
    return Plausible{cushion ? 1e-3 : 0, cushion ? 10.0 : 50.0, Plausible::kTravel, {"mm", "m", "cm", "um"}};
  if (si == "K") return Plausible{213, 573, Plausible::kMean, {"degC", "K"}};
  return std::nullopt;
}

constexpr double kFastest = 20, kSlowest = 1e-3;  ///< m/s, of a cushion's fastest movement

std::string Shown(double si, const Unit& unit, std::string_view name) {
  return fmt::format("{:.4g} {}", (si - unit.offset) / unit.scale, name);
}

}  // namespace

struct SizeWatch::Range {
  double low = kNaN, high = kNaN, mean = kNaN;
  bool moves = false;  ///< smoothly, more than noise makes of a signal at rest

  double Measure(const Plausible& by) const {
    if (by.measure == Plausible::kTravel) return high - low;
    return by.measure == Plausible::kMean ? mean : std::max(std::abs(low), std::abs(high));
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
    return known[static_cast<std::size_t>(k)];
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
  const auto plausible = PlausibleFor(machine_, spec, unit->si);
  const Range seen = Seen(signal);
  if (!plausible || std::isnan(seen.low)) return {};
  const double measure = seen.Measure(*plausible);
  if (measure >= plausible->low && measure <= plausible->high) return {};
  // A machine at rest shows little of anything.
  if (measure < plausible->low && plausible->measure != Plausible::kMean && !seen.moves) return {};
  std::string better;
  for (const char* name : plausible->units) {
    const auto other = FindUnit(name);
    if (!other || name == spec.unit || !better.empty()) continue;
    const auto in_other = [&](double si) {
      return (si - unit->offset) / unit->scale * other->scale + other->offset;
    };
    const double size =
        Range{in_other(seen.low), in_other(seen.high), in_other(seen.mean)}.Measure(*plausible);
    if (size > 0 && size >= plausible->low && size <= plausible->high) better = name;
  }
  // A sensor of an optional signal that is broken stops nothing; a wrong unit does.
  if (!spec.required && better.empty()) return {};
  Unit scale = *unit;
  if (plausible->measure != Plausible::kMean) scale.offset = 0;  // of a difference
  const auto shown = [&](double si) { return Shown(si, scale, spec.unit); };
  const std::string what = plausible->measure == Plausible::kTravel ? "travels by"
                           : plausible->measure == Plausible::kMean ? "is at"
                                                                    : "reaches";
  return BadInput(
      "{}: signal {} (column {}) {} {}, which no such machine does; plausible: {} to {}. {}", machine_.name,
      spec.name, spec.column, what, shown(measure), shown(plausible->low), shown(plausible->high),
      better.empty()
          ? fmt::format("Check unit, scale and offset of [signals] {} in the machine file", spec.name)
          : fmt::format("Its numbers look like {}: set unit = \"{}\" for {} in [signals] of the machine file",
                        better, better, spec.name));
}

/// The speed of a position says whether the time is in the unit that the machine file states.
Status SizeWatch::JudgeSpeed(std::size_t signal) const {
  const std::vector<double>& z = means_[signal];
  std::vector<double> speeds;
  for (std::size_t k = 1; k < z.size(); ++k)
    if (std::isfinite(z[k] - z[k - 1])) speeds.push_back(std::abs(z[k] - z[k - 1]) / piece_time_);
  if (speeds.size() < 100) return {};
  const auto top =
      speeds.begin() + static_cast<std::ptrdiff_t>((1 - kOutside) * static_cast<double>(speeds.size()));
  std::nth_element(speeds.begin(), top, speeds.end());
  if (*top >= kSlowest && *top <= kFastest) return {};
  if (*top < kSlowest && !Seen(signal).moves) return {};
  return BadInput(
      "{}: signal {} moves at {:.3g} mm/s at most, which no such machine does; plausible: {:g} to {:g} mm/s. "
      "Rows are "
      "{:.4g} s apart with the time in {}: check the unit of time (or sample_period) in [log] of the machine "
      "file, and the unit of {}",
      machine_.name, machine_.signals[signal].name, *top * 1e3, kSlowest * 1e3, kFastest * 1e3,
      piece_time_ / kPiece, machine_.log.time_unit, machine_.signals[signal].name);
}

Status SizeWatch::Judge() const {
  for (std::size_t s = 0; s < machine_.signals.size(); ++s)
    if (const Status plausible = JudgeSignal(s); !plausible) return plausible;
  const int position = machine_.model == "die_cushion" ? machine_.SignalIndex("z") : -1;
  return position < 0 ? Status() : JudgeSpeed(static_cast<std::size_t>(position));
}

Status JudgeGeometry(const Machine& machine) {
  for (const MachineInput& value : KindOf(machine).geometry) {
    const auto known = machine.Geometry(std::string(value.name));
    const bool any = !(value.highest > value.lowest);
    if (!known || any || (known->value >= value.lowest && known->value <= value.highest)) continue;
    const Unit unit = FindUnit(value.unit).value_or(Unit{});
    return BadInput(
        "{}: {} = {} is no {} of such a machine; plausible: {} to {}. Check value and unit of {} in "
        "[geometry] of the machine file",
        machine.name, value.name, Shown(known->value, unit, value.unit), value.meaning,
        Shown(value.lowest, unit, value.unit), Shown(value.highest, unit, value.unit), value.name);
  }
  return {};
}

Status JudgeSizes(const std::string& log, const Machine& machine) {
  if (const Status plausible = JudgeGeometry(machine); !plausible) return plausible;
  auto reader = OpenRecording(log, machine);
  if (!reader) return tl::unexpected(reader.error());
  SizeWatch watch(machine, (*reader)->SamplePeriod());
  SampleBlock block;
  Status seen;
  for (;;) {
    const auto rows = (*reader)->Read(block, kRowsPerLook);
    if (!rows || *rows == 0) break;  // what stops the reading is told by the pass that follows
    watch.Observe(block);
    seen = watch.Judge();
    if (seen) return {};
  }
  if (!seen) return BadInput("{}: {}", log, seen.error().text);
  return {};
}

Status JudgeStrokes(const std::string& database, const Machine& machine,
                    std::span<const StrokeSummary> strokes) {
  if (const Status plausible = JudgeGeometry(machine); !plausible) return plausible;
  if (machine.model != "die_cushion") return {};
  constexpr double kLow = 5e5, kHigh = 1e8;  // Pa, as of p_A
  double pressure = 0, speed = 0;
  for (const StrokeSummary& stroke : strokes) {
    pressure = std::max(pressure, stroke.mean_pressure);
    speed = std::max(speed, stroke.mean_speed);
  }
  if (pressure > 0 && (pressure < kLow || pressure > kHigh))
    return BadInput(
        "{}: the strokes of {} have mean pressures of {:.4g} bar, which no such machine has; plausible: {:g} "
        "to {:g} bar. "
        "They were replayed with a wrong unit of p_A: correct the machine file and replay into a new "
        "database",
        database, machine.name, pressure * 1e-5, kLow * 1e-5, kHigh * 1e-5);
  if (speed > kFastest)
    return BadInput(
        "{}: the strokes of {} have mean speeds of {:.4g} m/s, plausible: up to {:g} m/s. They were replayed "
        "with a wrong "
        "unit of z or of the time: correct the machine file and replay into a new database",
        database, machine.name, speed, kFastest);
  return {};
}

}  // namespace hydroscope
