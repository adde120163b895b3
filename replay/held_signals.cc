#include "replay/held_signals.h"

#include <algorithm>
#include <cmath>

#include "core/quantile.h"
#include "models/machine_kind.h"
#include "replay/rhythm.h"

namespace hydroscope {
namespace {

/// Rows between new readings: a signal that stands still for longer rests.
constexpr std::size_t kLongest = 16;

bool IsCommand(const Machine& machine, const MachineKind& kind, std::size_t signal) {
  return std::ranges::any_of(kind.standstill, [&](const StandstillRule& rule) {
    return machine.SignalIndex(rule.command) == static_cast<int>(signal);
  });
}

/// A coarse reading of a steady motion changes by its resolution each time.
bool IsCoarse(const std::vector<double>& column, const Rhythm& rhythm) {
  constexpr double kMostly = 0.5, kSame = 1e-6;
  std::vector<double> steps;
  for (const std::size_t row : rhythm.changes) steps.push_back(std::abs(column[row] - column[row - 1]));
  const double usual = Median(steps, 0);
  const auto same =
      std::ranges::count_if(steps, [&](double step) { return std::abs(step - usual) <= kSame * usual; });
  return static_cast<double>(same) >= kMostly * static_cast<double>(steps.size());
}

/// Draws the lines in rows that come piece by piece.
class LinesBetween {
 public:
  explicit LinesBetween(const HeldSignals& held) {
    for (const std::size_t signal : held.signals) tracks_.push_back({signal});
  }
  /// Those that end in the rows from `first` on.
  void Draw(SampleBlock& rows, std::size_t first) {
    for (std::size_t row = first; row < rows.rows(); ++row)
      for (Track& track : tracks_) DrawTo(static_cast<std::ptrdiff_t>(row), rows, track);
  }
  /// The first `rows` are gone.
  void Drop(std::size_t rows) {
    for (Track& track : tracks_) track.last -= static_cast<std::ptrdiff_t>(rows);
  }

 private:
  struct Track {
    std::size_t signal;
    std::ptrdiff_t last = -1;  ///< row with its last new reading; below 0: none
  };

  static void DrawTo(std::ptrdiff_t row, SampleBlock& rows, Track& track) {
    std::vector<double>& value = rows.signal[track.signal];
    if (rows.quality[track.signal][row] != quality::kGood) {
      track.last = -1;
      return;
    }
    if (track.last >= 0 && value[row] == value[track.last]) return;
    if (track.last >= 0 && row - track.last <= static_cast<std::ptrdiff_t>(kLongest) &&
        rows.time[row] > rows.time[track.last]) {
      const double slope = (value[row] - value[track.last]) / (rows.time[row] - rows.time[track.last]);
      for (std::ptrdiff_t held = track.last + 1; held < row; ++held)
        value[held] = value[track.last] + slope * (rows.time[held] - rows.time[track.last]);
    }
    track.last = row;
  }

  std::vector<Track> tracks_;
};

class DrawnReader : public LogReader {
 public:
  DrawnReader(std::unique_ptr<LogReader> inner, const HeldSignals& held)
      : inner_(std::move(inner)), why_(held.why), lines_(held) {
    Count();
  }

  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    while (!ended_ && coming_.rows() < max_rows + kLongest) {
      const auto read = inner_->Read(next_, max_rows);
      Count();
      ended_ = !read || *read == 0;
      if (read)
        Append();
      else
        failed_ = read.error();
    }
    if (failed_ && coming_.rows() == 0) return tl::unexpected(*failed_);
    const std::size_t known = ended_ ? coming_.rows() : coming_.rows() - kLongest;
    Give(std::min(known, max_rows), block);
    return block.rows();
  }
  double Progress() const override { return inner_->Progress(); }
  double SamplePeriod() const override { return inner_->SamplePeriod(); }
  const LogCounters& counters() const override { return counters_; }

 private:
  void Append() {
    const std::size_t rows = coming_.rows();
    const auto add = [](auto& to, const auto& more) { to.insert(to.end(), more.begin(), more.end()); };
    coming_.Resize(next_.signal.size(), rows);
    add(coming_.time, next_.time);
    for (std::size_t s = 0; s < next_.signal.size(); ++s) {
      add(coming_.signal[s], next_.signal[s]);
      add(coming_.quality[s], next_.quality[s]);
    }
    lines_.Draw(coming_, rows);
  }

  void Give(std::size_t rows, SampleBlock& block) {
    block.Resize(coming_.signal.size(), 0);
    const auto move = [&](auto& from, auto& to) {
      const auto end = from.begin() + static_cast<std::ptrdiff_t>(rows);
      to.assign(from.begin(), end);
      from.erase(from.begin(), end);
    };
    move(coming_.time, block.time);
    for (std::size_t s = 0; s < coming_.signal.size(); ++s) {
      move(coming_.signal[s], block.signal[s]);
      move(coming_.quality[s], block.quality[s]);
    }
    lines_.Drop(rows);
  }

  void Count() {
    counters_ = inner_->counters();
    const Told& before = counters_.time_base;
    counters_.time_base = before.empty() ? why_ : Tell("{}; {}", "{}; {}", before, why_);
  }

  std::unique_ptr<LogReader> inner_;
  Told why_;
  LinesBetween lines_;
  SampleBlock next_, coming_;  ///< the rows not given out yet
  bool ended_ = false;
  std::optional<Error> failed_;  ///< where the log cannot be read further: told after the rows before
  LogCounters counters_;
};

}  // namespace

std::optional<HeldSignals> FindHeldSignals(const SampleBlock& head, const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  if (kind.has_states || MeasuredByResponse(kind)) return std::nullopt;
  HeldSignals held;
  Told names;
  for (std::size_t s = 0; s < head.signal.size(); ++s) {
    const Rhythm rhythm = RhythmOf(head.signal[s]);
    if (rhythm.kind != Rhythm::Kind::kHeld || rhythm.rows > kLongest || IsCommand(machine, kind, s) ||
        IsCoarse(head.signal[s], rhythm))
      continue;
    held.signals.push_back(s);
    const Told name =
        Tell("{} every {:.3g} rows", "{} alle {:.3g} Zeilen", machine.signals[s].name, rhythm.rows);
    names = names.empty() ? name : Tell("{}, {}", "{}, {}", names, name);
  }
  if (held.signals.empty()) return std::nullopt;
  held.why = Tell(
      "signals that are new every few rows only ({}) are drawn straight between new readings",
      "Signale, die nur alle paar Zeilen neu sind ({}), werden zwischen neuen Werten gerade gezogen", names);
  return held;
}

void DrawHeldSignals(const HeldSignals& held, SampleBlock& rows) { LinesBetween(held).Draw(rows, 0); }

std::unique_ptr<LogReader> WithDrawnSignals(std::unique_ptr<LogReader> reader, HeldSignals held) {
  return std::make_unique<DrawnReader>(std::move(reader), held);
}

}  // namespace hydroscope
