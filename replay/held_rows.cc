#include "replay/held_rows.h"

#include <algorithm>
#include <cmath>

#include "replay/retimed_reader.h"
#include "replay/rhythm.h"

namespace hydroscope {
namespace {

// Of the rows in which one of the signals changes, in so many each of them does.
constexpr double kTogether = 0.8;

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
    if (!machine.signals[s].required) continue;
    Rhythm rhythm = RhythmOf(head.signal[s]);
    if (rhythm.kind == Rhythm::Kind::kEveryRow) return std::nullopt;
    if (rhythm.kind != Rhythm::Kind::kHeld) continue;
    held.signals.push_back(s);
    changes.push_back(std::move(rhythm.changes));
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
