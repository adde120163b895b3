#include "replay/held_rows.h"

#include <algorithm>
#include <cmath>

#include "core/quantile.h"
#include "replay/retimed_reader.h"

namespace hydroscope {
namespace {

constexpr std::size_t kLeastChanges = 50;  // that tell a rhythm
// Of the rows between two changes: so many lie within one row of the middle one, and hardly one follows the other at once.
constexpr double kInRhythm = 0.8, kAtOnce = 0.1;
// Of the rows in which one of the signals changes, in so many each of them does.
constexpr double kTogether = 0.8;

bool Differ(double a, double b) { return a != b && !(std::isnan(a) && std::isnan(b)); }

/// Rows of a column in which it changes.
std::vector<std::size_t> Changes(const std::vector<double>& column) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 1; row < column.size(); ++row)
    if (Differ(column[row], column[row - 1])) rows.push_back(row);
  return rows;
}

enum class Rhythm { kNone, kEveryRow, kHeld };

Rhythm RhythmOf(const std::vector<std::size_t>& changes) {
  if (changes.size() < kLeastChanges) return Rhythm::kNone;
  std::vector<double> apart;
  for (std::size_t k = 1; k < changes.size(); ++k)
    apart.push_back(static_cast<double>(changes[k] - changes[k - 1]));
  const double middle = Median(apart, 0);
  const auto share = [&](auto&& holds) {
    return static_cast<double>(std::ranges::count_if(apart, holds)) / static_cast<double>(apart.size());
  };
  if (share([](double rows) { return rows == 1; }) > kAtOnce) return Rhythm::kEveryRow;
  return share([&](double rows) { return std::abs(rows - middle) <= 1; }) >= kInRhythm ? Rhythm::kHeld
                                                                                       : Rhythm::kNone;
}

class NewRowsReader : public RetimedReader {
 public:
  NewRowsReader(std::unique_ptr<LogReader> inner, HeldRows held)
      : RetimedReader(std::move(inner), held.period, held.why), signals_(std::move(held.signals)) {}

 private:
  void Retime(SampleBlock& block) override {
    KeepRows(block, [&](std::size_t row) { return IsNew(block, row); });
  }
  bool IsNew(const SampleBlock& block, std::size_t row) {
    bool is_new = last_.empty();
    last_.resize(signals_.size());
    for (std::size_t k = 0; k < last_.size(); ++k) {
      const double value = block.signal[signals_[k]][row];
      is_new = is_new || Differ(value, last_[k]);
      last_[k] = value;
    }
    return is_new;
  }

  std::vector<std::size_t> signals_;
  std::vector<double> last_;  ///< their values in the row before
};

}  // namespace

std::optional<HeldRows> FindHeldRows(const SampleBlock& head, const Machine& machine) {
  HeldRows held;
  std::vector<std::vector<std::size_t>> changes;
  for (std::size_t s = 0; s < head.signal.size(); ++s) {
    std::vector<std::size_t> of_signal = Changes(head.signal[s]);
    const Rhythm rhythm = RhythmOf(of_signal);
    if (rhythm == Rhythm::kEveryRow && machine.signals[s].required) return std::nullopt;
    if (rhythm != Rhythm::kHeld || !machine.signals[s].required) continue;
    held.signals.push_back(s);
    changes.push_back(std::move(of_signal));
  }
  if (held.signals.size() < 2) return std::nullopt;
  std::vector<std::size_t> any;
  for (const auto& rows : changes) any.insert(any.end(), rows.begin(), rows.end());
  std::ranges::sort(any);
  any.erase(std::unique(any.begin(), any.end()), any.end());
  for (const auto& rows : changes)
    if (static_cast<double>(rows.size()) < kTogether * static_cast<double>(any.size())) return std::nullopt;
  std::vector<double> times;
  for (const std::size_t row : any) times.push_back(head.time[row]);
  held.period = SamplePeriodOf(times);
  if (!(held.period > 0)) return std::nullopt;
  const double rows = static_cast<double>(any.back() - any.front()) / static_cast<double>(any.size() - 1);
  held.why = Tell(
      "the logger repeats what it got: signals change together every {:.2g} rows only; the rows between are left out",
      "der Logger wiederholt, was er bekam: Signale ändern sich gemeinsam nur alle {:.2g} Zeilen; die Zeilen dazwischen bleiben weg",
      rows);
  return held;
}

std::unique_ptr<LogReader> WithoutHeldRows(std::unique_ptr<LogReader> reader, HeldRows held) {
  return std::make_unique<NewRowsReader>(std::move(reader), std::move(held));
}

}  // namespace hydroscope
