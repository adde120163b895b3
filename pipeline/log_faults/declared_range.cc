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
    if (unit && unit->offset == 0 && spec.min && spec.max && !IsSizeKnown(machine, spec))
      watched_.push_back({.signal = s});
  }
}

void DeclaredRanges::Observe(const SampleBlock& block) {
  constexpr Quality kNoReading = quality::kMissing | quality::kSpike;
  for (Readings& readings : watched_)
    for (std::size_t row = 0; row < block.rows(); ++row) {
      const double x = block.signal[readings.signal][row];
      if (!std::isfinite(x) || (block.quality[readings.signal][row] & kNoReading) != 0) continue;
      readings.low = readings.seen ? std::min(readings.low, x) : x;
      readings.high = readings.seen ? std::max(readings.high, x) : x;
      readings.seen = true;
    }
}

std::vector<Told> DeclaredRanges::Sentences() const {
  std::vector<Told> sentences;
  for (const Readings& readings : watched_)
    if (Told sentence = SentenceOf(readings); !sentence.empty()) sentences.push_back(std::move(sentence));
  return sentences;
}

Told DeclaredRanges::SentenceOf(const Readings& readings) const {
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
