#include "pipeline/log_faults/reading_faults.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/units.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

/// One jump is a sensor set anew, which strokes on either side of it survive.
constexpr std::int64_t kJumpsToRefuse = 3;
/// Standard deviations of the noise that no two readings differ by.
constexpr double kNoiseReach = 17;
/// Of a jump over the steps beside it, and over all but the largest tenth of those that are any: about the place where a counter
/// overflows the noise makes it jump to and fro.
constexpr double kSharp = 5;
constexpr double kMost = 0.9;
/// Of a jump: so much of it is left where the signal stays there.
constexpr double kStays = 0.5;
/// Rows that may be flagged between two readings: less than kSharp, so that steady motion over them is no jump.
constexpr double kRowsBetween = 4.5;
/// Rows that tell whether a signal moves.
constexpr std::int64_t kRowsToCompare = 1000;
/// Of the variance: what is left of an echo is rounding.
constexpr double kLeftOfEcho = 1e-8;

}  // namespace

ReadingFaults::ReadingFaults(const Machine& machine, double sample_period)
    : machine_(machine), period_(sample_period) {
  const MachineKind& kind = KindOf(machine);
  for (const Condition& condition : kind.conditions) {
    const int signal = machine.SignalIndex(condition.signal);
    if (condition.of == Condition::Of::kMeanRate && signal >= 0)
      tracks_.push_back({.signal = static_cast<std::size_t>(signal)});
  }
  for (const StandstillRule& rule : kind.standstill) {
    const int signal = machine.SignalIndex(rule.signal), command = machine.SignalIndex(rule.command);
    if (signal >= 0 && command >= 0)
      pairs_.push_back(
          {.signal = static_cast<std::size_t>(signal), .command = static_cast<std::size_t>(command)});
  }
}

void ReadingFaults::Observe(const SampleBlock& block, const std::vector<ChannelQuality>& channels) {
  for (Track& track : tracks_) {
    const double noise = channels[track.signal].noise_std;
    const double reach = std::isfinite(noise) ? kNoiseReach * noise : 0.0;
    for (std::size_t row = 0; row < block.rows(); ++row) {
      if (block.quality[track.signal][row] != quality::kGood) continue;
      if (!(std::abs(block.time[row] - track.times.back()) < kRowsBetween * period_)) track.readings = 0;
      Follow(block.time[row], block.signal[track.signal][row], reach, track);
    }
  }
  for (Pair& pair : pairs_)
    for (std::size_t row = 0; row < block.rows(); ++row) {
      if ((block.quality[pair.signal][row] | block.quality[pair.command][row]) != quality::kGood) continue;
      const double signal = block.signal[pair.signal][row], command = block.signal[pair.command][row];
      if (pair.rows++ == 0) pair.signal_at = signal, pair.command_at = command;
      const double y = signal - pair.signal_at, x = command - pair.command_at;
      pair.x += x, pair.y += y, pair.xx += x * x, pair.yy += y * y, pair.xy += x * y;
    }
}

/// Whether the readings after the step in the middle lie beside those before it, apart from how they move, by half of it.
bool ReadingFaults::StaysAfterTheMiddle(const Track& track) {
  const auto median = [](auto values) {
    const auto middle = values.begin() + values.size() / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const std::array<double, 2 * kBeside>& v = track.values;
  std::array<double, kBeside> before{}, after{};
  std::array<double, 2 * (kBeside - 1)> steps{};
  std::copy_n(v.begin(), kBeside, before.begin());
  std::copy_n(v.begin() + kBeside, kBeside, after.begin());
  for (std::size_t i = 1; i < kBeside; ++i) {
    steps[i - 1] = v[i] - v[i - 1];
    steps[kBeside + i - 2] = v[kBeside + i] - v[kBeside + i - 1];
  }
  const double moved = median(after) - median(before) - static_cast<double>(kBeside) * median(steps);
  const double jump = v[kBeside] - v[kBeside - 1];
  return moved / jump > kStays;
}

/// Takes a reading in, and judges the step in the middle of the last ones by those beside it.
void ReadingFaults::Follow(double time, double value, double reach, Track& track) {
  std::array<double, 2 * kBeside>& v = track.values;
  if (const double step = value - v.back(); track.readings >= 1 && step != 0)
    ++track.all[kBins.Of(std::abs(step))];
  std::shift_left(v.begin(), v.end(), 1);
  std::shift_left(track.times.begin(), track.times.end(), 1);
  v.back() = value;
  track.times.back() = time;
  track.readings = std::min(track.readings + 1, v.size());
  if (track.readings < v.size()) return;
  const auto step_to = [&](std::size_t i) { return std::abs(v[i] - v[i - 1]); };
  const double jump = step_to(kBeside);
  if (!(jump > reach) || !(jump > kSharp * step_to(kBeside + 1)) || !(jump > kSharp * step_to(kBeside - 1)))
    return;
  if (!StaysAfterTheMiddle(track)) return;
  const std::size_t bin = kBins.Of(jump);
  if (track.sharp[bin]++ == 0) track.first[bin] = track.times[kBeside];
}

ReadingFaults::Jumps ReadingFaults::JumpsOf(const Track& track) {
  const std::int64_t steps = std::accumulate(track.all.begin(), track.all.end(), std::int64_t{0});
  const auto size_of = [](std::size_t bin) { return kBins.SizeAt(static_cast<double>(bin)); };
  std::size_t bin = 0;
  for (std::int64_t below = 0; bin < kBins.count; ++bin) {
    below += track.all[bin];
    if (static_cast<double>(below) >= kMost * static_cast<double>(steps)) break;
  }
  Jumps jumps;
  const double most = kSharp * size_of(bin + 1);
  for (; bin < kBins.count; ++bin) {
    if (size_of(bin) < most || track.sharp[bin] == 0) continue;
    if (jumps.count == 0 || track.first[bin] < jumps.first) jumps.first = track.first[bin];
    jumps.count += track.sharp[bin];
    jumps.size = size_of(bin);
  }
  return jumps;
}

bool ReadingFaults::Pair::IsEcho() const {
  if (rows < kRowsToCompare) return false;
  const auto n = static_cast<double>(rows);
  const double var_x = xx - x * x / n, var_y = yy - y * y / n, both = xy - x * y / n;
  return var_x > 0 && var_y > 0 && var_y - both * both / var_x < kLeftOfEcho * var_y;
}

Told ReadingFaults::NoVerdict() const {
  for (const Track& track : tracks_) {
    const Jumps jumps = JumpsOf(track);
    if (jumps.count < kJumpsToRefuse) continue;
    const SignalSpec& spec = machine_.signals[track.signal];
    const Unit unit = FindUnit(spec.unit).value_or(Unit{});
    return Tell(
        "signal {} (column {}) jumps {} times from one row to the next, by some {:.2g} {}, first at {:.4g} s, and stays there, "
        "which no such machine does: a counter that overflows or loses steps, or pieces of a log that were joined with new time "
        "stamps. Record its full count, mend the reading, or keep the stamps of the pieces",
        "Signal {} (Spalte {}) springt {}-mal von einer Zeile zur nächsten, um etwa {:.2g} {}, zuerst bei {:.4g} s, und bleibt "
        "dort, was keine solche Maschine tut: ein Zähler, der überläuft oder Schritte verliert, oder Stücke eines Logs, die mit "
        "neuen Zeitstempeln aneinandergesetzt wurden. Den ganzen Zählerstand aufzeichnen, die Anzeige in der Steuerung berichtigen "
        "oder die Zeitstempel der Stücke behalten",
        spec.name, spec.column, jumps.count, jumps.size / unit.scale, spec.unit, jumps.first);
  }
  return {};
}

std::vector<ReadingFaults::Echo> ReadingFaults::Echoes() const {
  std::vector<Echo> echoes;
  for (const Pair& pair : pairs_)
    if (pair.IsEcho())
      echoes.push_back({machine_.signals[pair.signal].name, machine_.signals[pair.command].name});
  return echoes;
}

Told ReadingFaults::Echo::Sentence() const {
  return Tell(
      "{0} repeats {1}, so {0} is not measured: what lies between the two looks like signals that are late",
      "{0} wiederholt {1}, wird also nicht gemessen: was zwischen beiden liegt, sieht aus wie Signale, die sich "
      "verspäten",
      signal, command);
}

}  // namespace hydroscope
