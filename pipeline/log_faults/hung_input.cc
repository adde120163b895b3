#include "pipeline/log_faults/hung_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/records/quality.h"
#include "pipeline/episode_cutter.h"

namespace hydroscope {
namespace {

/// Rows `begin` up to `end`.
struct RowRange {
  std::size_t begin = 0, end = 0;
};

/// Where the monitor says that the signal is stuck.
std::vector<RowRange> StuckRuns(const std::vector<double>& x, const std::vector<Quality>& flags) {
  std::vector<RowRange> runs;
  for (std::size_t row = 0; row < x.size(); ++row) {
    if ((flags[row] & quality::kStuck) == 0) continue;
    const bool goes_on = !runs.empty() && runs.back().end == row && x[row] == x[runs.back().begin];
    if (goes_on)
      runs.back().end = row + 1;
    else
      runs.push_back({row, row + 1});
  }
  return runs;
}

/// Whether noise of more than a converter's step scatters the readings before a row.
bool NoiseScattersBefore(const std::vector<double>& x, std::size_t row, const HungInputOptions& options) {
  const std::size_t first = row - std::min(row, static_cast<std::size_t>(options.rows_before));
  double squares = 0, products = 0, before = NAN;
  int count = 0, repeats = 0;
  for (std::size_t k = first; k + 3 < row; ++k) {
    const double third = x[k + 3] - 3 * (x[k + 2] - x[k + 1]) - x[k];
    repeats += x[k + 1] == x[k];
    if (std::isfinite(third) && std::isfinite(before)) {
      squares += third * third;
      products += third * before;
      ++count;
    }
    before = third;
  }
  return count >= options.least_before && squares > 0 && products < options.of_noise * squares &&
         repeats < options.repeats * count;
}

/// Range of means of some rows.
double RangeOf(const std::vector<double>& y, const RowRange& range, int smooth) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto rows = static_cast<std::size_t>(smooth);
  for (std::size_t first = range.begin; first + rows <= range.end; first += rows) {
    double sum = 0;
    for (std::size_t k = first; k < first + rows; ++k) sum += y[k];
    if (!std::isfinite(sum)) continue;
    low = std::min(low, sum / smooth);
    high = std::max(high, sum / smooth);
  }
  return high > low ? high - low : 0;
}

/// Whether an output goes on moving through the second half of these rows.
bool OutputsMoveOn(std::span<const int> outputs, const SampleBlock& rows, const RowRange& range,
                   const HungInputOptions& options) {
  const RowRange second_half{range.begin + (range.end - range.begin) / 2, range.end};
  return std::ranges::any_of(outputs, [&](int output) {
    const std::vector<double>& y = rows.signal[static_cast<std::size_t>(output)];
    const double whole = RangeOf(y, {0, rows.rows()}, options.smooth);
    return whole > 0 && RangeOf(y, second_half, options.smooth) > options.moves * whole;
  });
}

bool StandsAlways(const std::vector<double>& x) {
  const auto first = std::ranges::find_if(x, [](double reading) { return std::isfinite(reading); });
  return first != x.end() && std::ranges::all_of(x, [first](double reading) {
           return !std::isfinite(reading) || reading == *first;
         });
}

}  // namespace

std::vector<FrozenStretch> HungInputs(const Machine& machine, std::span<const int> inputs,
                                      std::span<const int> outputs, const SampleBlock& rows,
                                      const HungInputOptions& options) {
  std::vector<FrozenStretch> hung;
  if (rows.rows() < 2) return hung;
  const double period = (rows.time.back() - rows.time.front()) / static_cast<double>(rows.rows() - 1);
  for (const int input : inputs) {
    const auto s = static_cast<std::size_t>(input);
    if (!EpisodeCutter::JudgesStuck(machine.signals[s], period)) continue;
    for (const RowRange& run : StuckRuns(rows.signal[s], rows.quality[s]))
      if (NoiseScattersBefore(rows.signal[s], run.begin, options) &&
          OutputsMoveOn(outputs, rows, run, options))
        hung.push_back({s, rows.time[run.begin], rows.time[run.end - 1]});
  }
  return hung;
}

void LeaveOutHung(std::span<const FrozenStretch> hung, SampleBlock& block) {
  for (const FrozenStretch& stretch : hung)
    for (std::size_t row = 0; row < block.rows(); ++row)
      if (block.time[row] >= stretch.begin && block.time[row] <= stretch.end) {
        block.signal[stretch.signal][row] = NAN;
        block.quality[stretch.signal][row] |= quality::kStuck | quality::kMissing;
      }
}

std::vector<Told> HungTexts(std::span<const FrozenStretch> hung, const Machine& machine) {
  std::vector<Told> texts;
  for (std::size_t s = 0; s < machine.signals.size(); ++s) {
    const auto is_its = [s](const FrozenStretch& stretch) { return stretch.signal == s; };
    const auto first = std::ranges::find_if(hung, is_its);
    if (first == hung.end()) continue;
    const auto more = std::ranges::count_if(hung, is_its) - 1;
    texts.push_back(Tell(
        "{} (column {}) repeats one reading from {:.2f} to {:.2f} s{} while outputs of the machine go on moving: its sensor, wire or "
        "logger hung, and that is left out; if it is a command that rested, say so by stuck_time = 0 of the signal",
        "{} (Spalte {}) wiederholt von {:.2f} bis {:.2f} s{} einen Messwert, während Ausgänge der Maschine sich weiter bewegen: Sensor, "
        "Leitung oder Logger hing, und das bleibt weg; wenn es ein Befehl ist, der ruhte, es durch stuck_time = 0 des Signals sagen",
        machine.signals[s].name, machine.signals[s].column, first->begin, first->end,
        more > 0 ? Tell(", and {} times more,", ", und noch {}-mal,", more) : Told()));
  }
  return texts;
}

Told NoInputMoves(const Machine& machine, std::span<const int> inputs, std::span<const int> outputs,
                  const SampleBlock& rows, const HungInputOptions& options) {
  const bool none = !inputs.empty() && std::ranges::all_of(inputs, [&](int input) {
    return StandsAlways(rows.signal[static_cast<std::size_t>(input)]);
  });
  if (!none || !OutputsMoveOn(outputs, rows, {0, rows.rows()}, options)) return {};
  Told names;
  for (const int input : inputs) {
    const SignalSpec& spec = machine.signals[static_cast<std::size_t>(input)];
    const Told name = Tell("{} (column {})", "{} (Spalte {})", spec.name, spec.column);
    names = names.empty() ? name : Tell("{}, {}", "{}, {}", names, name);
  }
  return Tell(
      "one and the same reading in the whole log of every input ({}), while outputs go on moving: if it was not held, its sensor or "
      "wire is not connected, and what comes out is wrong",
      "ein und derselbe Wert jedes Eingangs in der ganzen Aufzeichnung ({}), während Ausgänge sich weiter bewegen: wenn er nicht "
      "gehalten wurde, ist Sensor oder Leitung nicht angeschlossen, und was herauskommt, ist falsch",
      names);
}

}  // namespace hydroscope
