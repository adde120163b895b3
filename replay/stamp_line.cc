#include "replay/stamp_line.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/quantile.h"
#include "replay/time_check.h"

namespace hydroscope {
namespace {

// Steps of the clock that are a break.
constexpr double kBreak = 5.0;
// A window holds so many rows, and so many steps of a coarse clock; fewer windows tell no period.
constexpr double kWindowRows = 200, kWindowSteps = 8;
constexpr std::size_t kLeastWindows = 4;
// Of a period, by which the rows before and after a missing one are displaced at least.
constexpr double kDisplaced = 0.6, kDisplacedSpreads = 6.0;
// Breaks between windows up to which rows are even.
constexpr double kLargestShareOfBreaks = 0.25;
// How far stamps may lie from their line, in the spread that windows show.
constexpr double kOffTheLine = 1.6;
constexpr int kRounds = 3;  // of finding the period

/// Rows [begin, end) of one time base.
struct Span {
  std::size_t begin = 0, end = 0;
};

double RowsPerStep(const std::vector<double>& times) {
  std::int64_t steps = 1;
  for (std::size_t k = 1; k < times.size(); ++k) steps += times[k] > times[k - 1];
  return static_cast<double>(times.size()) / static_cast<double>(steps);
}

class LineFinder {
 public:
  explicit LineFinder(const std::vector<double>& times)
      : t_(times),
        clock_(SamplePeriodOf(times)),
        window_(static_cast<std::size_t>(std::max(kWindowRows, kWindowSteps * RowsPerStep(times)))) {}

  std::optional<StampLine> Find() {
    SplitAtBreaks();
    std::size_t windows = 0;
    ForWindows([&](const Span&, std::size_t) { ++windows; });
    if (windows < kLeastWindows) return std::nullopt;
    for (int round = 0; round < kRounds; ++round) CorrectPeriod();
    if (!(period_ > 0)) return std::nullopt;
    SplitWhereRowsAreMissing();
    if (static_cast<double>(spans_.size()) > 1 + kLargestShareOfBreaks * static_cast<double>(windows))
      return std::nullopt;
    PeriodOfAll();
    StampLine line;
    line.period = period_;
    const double spread = SpreadOfWindows();
    for (const Span& span : spans_) {
      const Offsets off = OffsetsIn(span);
      if (off.high - off.low > kOffTheLine * spread + period_) return std::nullopt;
      line.pieces.push_back({static_cast<std::int64_t>(span.begin), t_[span.begin] + off.mean});
    }
    KeepGaps(line);
    return line;
  }

 private:
  void SplitAtBreaks() {
    std::size_t begin = 0;
    for (std::size_t k = 1; k < t_.size(); ++k) {
      const double step = t_[k] - t_[k - 1];
      if (step <= kBreak * clock_ && step >= -clock_) continue;
      spans_.push_back({begin, k});
      begin = k;
    }
    if (begin < t_.size()) spans_.push_back({begin, t_.size()});
  }

  /// Calls `take` with the begin of every whole window of every span.
  template <class Take>
  void ForWindows(Take&& take) const {
    for (const Span& span : spans_)
      for (std::size_t at = span.begin; at + window_ <= span.end; at += window_) take(span, at);
  }

  /// Mean distance of a window's stamps from rows `period_` apart that begin with row 0 at 0 s.
  double Phase(std::size_t at) const {
    double sum = 0;
    for (std::size_t k = at; k < at + window_; ++k) sum += t_[k] - t_[at];
    const double middle = 0.5 * static_cast<double>(window_ - 1);
    return t_[at] - period_ * (static_cast<double>(at) + middle) + sum / static_cast<double>(window_);
  }

  /// Differences of phase between neighbouring windows.
  std::vector<double> Wander() const {
    std::vector<double> wander;
    double before = kNaN;
    ForWindows([&](const Span& span, std::size_t at) {
      const double phase = Phase(at);
      if (at != span.begin) wander.push_back(phase - before);
      before = phase;
    });
    return wander;
  }

  /// From any period, 0 too.
  void CorrectPeriod() { period_ += Median(Wander(), kNaN) / static_cast<double>(window_); }

  /// Where the phase moves from the window before a window to the one behind it by most of a period or more, rows are missing.
  void SplitWhereRowsAreMissing() {
    std::vector<double> spread;
    for (const double step : Wander()) spread.push_back(std::abs(step));
    const double least = std::max(
        kDisplaced * period_, kDisplacedSpreads * Median(std::move(spread), kNaN) / kNormalMedianMagnitude);
    std::vector<Span> split;
    for (const Span& span : spans_) {
      std::size_t begin = span.begin;
      const auto displaced = [&](std::size_t at) {
        return at >= begin + window_ && at + 2 * window_ <= span.end
                   ? std::abs(Phase(at + window_) - Phase(at - window_))
                   : 0.0;
      };
      for (std::size_t at = span.begin + window_; at + 2 * window_ <= span.end; at += window_) {
        if (displaced(at) < least || displaced(at + window_) > displaced(at)) continue;
        const std::size_t missing = PlaceOfStep(at - window_, at + 2 * window_);
        split.push_back({begin, missing});
        begin = missing;
        at += window_;
      }
      split.push_back({begin, span.end});
    }
    spans_ = std::move(split);
  }

  /// First row behind a step of the phase: where two means describe the stamps best.
  std::size_t PlaceOfStep(std::size_t begin, std::size_t end) const {
    const auto off = [&](std::size_t k) {
      return t_[k] - t_[begin] - period_ * static_cast<double>(k - begin);
    };
    double all = 0, before = 0, best = -1;
    for (std::size_t k = begin; k < end; ++k) all += off(k);
    std::size_t place = begin + 1;
    for (std::size_t k = begin + 1; k < end; ++k) {
      before += off(k - 1);
      const auto left = static_cast<double>(k - begin), right = static_cast<double>(end - k);
      const double apart = before / left - (all - before) / right;
      const double between = apart * apart * left * right;
      if (between <= best) continue;
      best = between;
      place = k;
    }
    return place;
  }

  /// Least squares through all spans, each with a beginning of its own.
  void PeriodOfAll() {
    double rows_squared = 0, rows_times = 0;
    for (const Span& span : spans_) {
      const auto n = static_cast<double>(span.end - span.begin);
      const double middle = 0.5 * (n - 1);
      for (std::size_t k = span.begin; k < span.end; ++k) {
        const double row = static_cast<double>(k - span.begin) - middle;
        rows_times += row * (t_[k] - t_[span.begin]);
      }
      rows_squared += n * (n * n - 1) / 12;
    }
    period_ = rows_times / rows_squared;
  }

  /// Of stamps from rows `period_` apart that begin with the first stamp, s.
  struct Offsets {
    double low = kInfinity, high = -kInfinity, mean = 0;
  };
  Offsets OffsetsIn(const Span& span) const {
    Offsets off;
    for (std::size_t k = span.begin; k < span.end; ++k) {
      const double here = t_[k] - t_[span.begin] - period_ * static_cast<double>(k - span.begin);
      off.low = std::min(off.low, here);
      off.high = std::max(off.high, here);
      off.mean += here / static_cast<double>(span.end - span.begin);
    }
    return off;
  }

  double SpreadOfWindows() const {
    std::vector<double> spreads;
    ForWindows([&](const Span&, std::size_t at) {
      const Offsets off = OffsetsIn({at, at + window_});
      spreads.push_back(off.high - off.low);
    });
    return Median(std::move(spreads), kNaN);
  }

  /// A piece begins at least one missing row behind the one before, which coarse stamps may place a little earlier. A clock that
  /// went back stays so.
  void KeepGaps(StampLine& line) const {
    for (std::size_t k = 1; k < line.pieces.size(); ++k) {
      const StampLine::Piece& before = line.pieces[k - 1];
      StampLine::Piece& piece = line.pieces[k];
      const double least = before.time + period_ * static_cast<double>(piece.first - before.first + 1);
      if (piece.time < least && piece.time > least - clock_ - period_) piece.time = least;
    }
  }

  const std::vector<double>& t_;
  double clock_;  ///< s
  std::size_t window_;
  std::vector<Span> spans_;
  double period_ = 0;  ///< s
};

}  // namespace

std::optional<StampLine> LineThrough(const std::vector<double>& times) { return LineFinder(times).Find(); }

}  // namespace hydroscope
