#include "pipeline/log_faults/declared_range.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/records/quality.h"
#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// Whether the machine's kind tells what size a signal has.
bool IsSizeKnown(const Machine& machine, const SignalSpec& spec) {
  return std::ranges::any_of(KindOf(machine).signals, [&](const MachineInput& input) {
    return input.name == spec.name && input.size.has_value();
  });
}

/// The unit of which the readings would fill the range that the machine file declares, if any.
std::string UnitThatFills(const SignalSpec& spec, const Unit& unit, double largest, double declared,
                          double least) {
  for (const std::string& name : UnitNames()) {
    const auto other = FindUnit(name);
    if (!other || name == spec.unit || other->si != unit.si || other->offset != 0) continue;
    const double share = largest / unit.scale * other->scale / declared;
    if (share > least && share <= 1) return name;
  }
  return {};
}

}  // namespace

DeclaredRanges::DeclaredRanges(const Machine& machine, const DeclaredRangeOptions& options)
    : machine_(machine), options_(options) {
  for (std::size_t s = 0; s < machine.signals.size(); ++s) {
    const SignalSpec& spec = machine.signals[s];
    const auto unit = FindUnit(spec.unit);
    if (!unit || (!spec.min && !spec.max)) continue;
    const bool sized = unit->offset != 0 || !spec.min || !spec.max || IsSizeKnown(machine, spec);
    watched_.push_back({.signal = s, .of_unknown_size = !sized});
  }
}

bool DeclaredRanges::IsOutside(const Readings& readings, double x) const {
  const SignalSpec& spec = machine_.signals[readings.signal];
  return x < spec.min.value_or(x) || x > spec.max.value_or(x);
}

void DeclaredRanges::Observe(const SampleBlock& block) {
  constexpr Quality kNoReading = quality::kMissing | quality::kSpike;
  for (Readings& readings : watched_)
    for (std::size_t row = 0; row < block.rows(); ++row) {
      const double x = block.signal[readings.signal][row];
      if (!std::isfinite(x) || (block.quality[readings.signal][row] & kNoReading) != 0) continue;
      readings.low = readings.seen > 0 ? std::min(readings.low, x) : x;
      readings.high = readings.seen > 0 ? std::max(readings.high, x) : x;
      ++readings.seen;
      readings.outside += IsOutside(readings, x);
      readings.reversed_outside += IsOutside(readings, -x);
    }
}

std::vector<Told> DeclaredRanges::Sentences() const {
  std::vector<Told> sentences;
  for (const Readings& readings : watched_)
    for (Told sentence : {SizeText(readings), OutsideText(readings)})
      if (!sentence.empty()) {
        sentences.push_back(std::move(sentence));
        break;
      }
  return sentences;
}

Told DeclaredRanges::OutsideText(const Readings& readings) const {
  const auto share_of = [&](std::int64_t rows) {
    return static_cast<double>(rows) / static_cast<double>(std::max<std::int64_t>(1, readings.seen));
  };
  const double share = share_of(readings.outside), reversed = share_of(readings.reversed_outside);
  if (share <= options_.most_outside) return {};
  const SignalSpec& spec = machine_.signals[readings.signal];
  return Tell(
      "{} (column {}): {:.0f} % of the readings lie outside of min and max of the machine file and are left out, and what needs them goes "
      "without: look at its unit, scale, offset and range{}",
      "{} (Spalte {}): {:.0f} % der Messwerte liegen außerhalb von min und max der Maschinendatei und bleiben weg, und was sie braucht, "
      "kommt ohne aus: Einheit, Skalierung, Nullpunkt und Bereich ansehen{}",
      spec.name, spec.column, 100 * share,
      reversed < options_.most_outside && share > 1 - options_.most_outside
          ? Tell(". With its sign reversed they would lie inside: set scale = -1",
                 ". Mit umgekehrtem Vorzeichen lägen sie innerhalb: scale = -1 setzen")
          : Told{});
}

Told DeclaredRanges::SizeText(const Readings& readings) const {
  if (!readings.of_unknown_size) return {};
  const SignalSpec& spec = machine_.signals[readings.signal];
  const Unit unit = *FindUnit(spec.unit);
  const double declared = std::max(std::abs(*spec.min), std::abs(*spec.max)),
               largest = std::max(std::abs(readings.low), std::abs(readings.high));
  if (!(declared > 0) || !(largest > 0) || !(readings.high > readings.low)) return {};
  const double share = largest / declared;
  if (share >= options_.least && share <= options_.most) return {};
  const std::string better = UnitThatFills(spec, unit, largest, declared, options_.least);
  return Tell(
      "{} (column {}): the readings reach {:.2g} {}, min and max of the machine file {:.2g} {}: look at its unit and scale{}",
      "{} (Spalte {}): die Werte reichen bis {:.2g} {}, min und max der Maschinendatei bis {:.2g} {}: stimmt die Einheit?{}",
      spec.name, spec.column, largest / unit.scale, spec.unit, declared / unit.scale, spec.unit,
      better.empty() ? Told{}
                     : Tell(". They look like {}: set unit = \"{}\"",
                            ". Sie sehen nach {} aus: unit = \"{}\" setzen", better, better));
}

}  // namespace hydroscope
