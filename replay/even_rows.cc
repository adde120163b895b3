#include "replay/even_rows.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/quantile.h"
#include "replay/time_check.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsAtOnce = 1000;
constexpr std::size_t kMostRows = 5'000'000;  // whose stamps are remembered, 40 MB
// Rows that repeat the stamp before, from which on stamps are coarse; twice the readings of a row are no row of their own.
constexpr double kCoarseShare = 0.1, kLargestShareOfCopies = 0.5;
// Steps that differ by more from the middle one, and their share from which on stamps jitter.
constexpr double kUnevenStep = 0.15, kUnevenShare = 0.2;
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
// Standard deviations by which signals must be smoother over even rows.
constexpr double kSmoother = 6.0;
constexpr double kMedianAbsolute = 0.6745;  // of a normal variable, in standard deviations

/// Energy that the middle one of three rows leaves beside the straight line through its neighbours, once as if rows were even
/// and once by the stamps: each in variances of white noise, so that noise alone gives twice the same.
struct Smoothness {
  double more = 0, squares = 0;  ///< by the stamps less over even rows, and the sum of the squares

  void Add(double early, double middle, double late, double step, double next) {
    const double share = step / (step + next);
    const double even = middle - 0.5 * (early + late),
                 stamped = middle - ((1 - share) * early + share * late);
    const double more_of_this =
        stamped * stamped / (1 + share * share + (1 - share) * (1 - share)) - even * even / 1.5;
    if (!std::isfinite(more_of_this)) return;
    more += more_of_this;
    squares += more_of_this * more_of_this;
  }
  double Deviations() const { return squares > 0 ? more / std::sqrt(squares) : 0; }
};

/// What the stamps of a log look like, and what its signals say of them.
class Stamps {
 public:
  void Add(const SampleBlock& block) {
    before_.resize(block.signal.size());
    at_.resize(block.signal.size());
    smooth_.resize(block.signal.size());
    for (std::size_t row = 0; row < block.rows(); ++row) AddRow(block, row);
  }

  const std::vector<double>& times() const { return times_; }
  bool Coarse() const {
    const auto rows = static_cast<double>(times_.size());
    return repeated_ >= kCoarseShare * rows && copies_ <= kLargestShareOfCopies * repeated_;
  }
  bool Jitter() const {
    const double middle = MiddleStep();
    std::int64_t uneven = 0, steps = 0;
    for (std::size_t k = 1; k < times_.size(); ++k) {
      const double step = times_[k] - times_[k - 1];
      if (!(step >= 0) || step > kBreak * middle) continue;
      ++steps;
      uneven += std::abs(step - middle) > kUnevenStep * middle;
    }
    return static_cast<double>(uneven) > kUnevenShare * static_cast<double>(steps);
  }
  /// The middle one of the steps forward, s.
  double MiddleStep() const {
    std::vector<double> steps;
    for (std::size_t k = 1; k < times_.size(); ++k)
      if (times_[k] > times_[k - 1]) steps.push_back(times_[k] - times_[k - 1]);
    return Median(std::move(steps), kNaN);
  }
  double RowsPerStep() const {
    std::int64_t steps = 1;
    for (std::size_t k = 1; k < times_.size(); ++k) steps += times_[k] > times_[k - 1];
    return static_cast<double>(times_.size()) / static_cast<double>(steps);
  }
  double RepeatedShare() const { return repeated_ / static_cast<double>(times_.size()); }
  bool SmootherOverRows() const {
    double most = 0, least = 0;
    for (const Smoothness& channel : smooth_) {
      most = std::max(most, channel.Deviations());
      least = std::min(least, channel.Deviations());
    }
    return most > kSmoother && least > -kSmoother;
  }

 private:
  void AddRow(const SampleBlock& block, std::size_t row) {
    const double t = block.time[row];
    const std::size_t rows = times_.size();
    const double step = rows > 1 ? times_[rows - 1] - times_[rows - 2] : kNaN;
    const double next = rows > 0 ? t - times_[rows - 1] : kNaN;
    bool copy = next == 0;
    for (std::size_t s = 0; s < block.signal.size(); ++s) {
      const double value = block.quality[s][row] & quality::kMissing ? kNaN : block.signal[s][row];
      if (step > 0 && next > 0 && next < 3 * step && step < 3 * next)
        smooth_[s].Add(before_[s], at_[s], value, step, next);
      copy = copy && value == at_[s];
      before_[s] = at_[s];
      at_[s] = value;
    }
    repeated_ += next == 0;
    copies_ += copy;
    times_.push_back(t);
  }

  std::vector<double> times_;         ///< s
  std::vector<double> before_, at_;   ///< values of the last two rows
  std::vector<Smoothness> smooth_;    ///< per channel
  double repeated_ = 0, copies_ = 0;  ///< rows with the stamp of the row before; those with its values too
};

/// Rows [begin, end) of one time base.
struct Span {
  std::size_t begin = 0, end = 0;
};

/// Finds the line that the stamps of even rows lie about.
class LineThroughStamps {
 public:
  explicit LineThroughStamps(const Stamps& stamps)
      : t_(stamps.times()),
        clock_(stamps.MiddleStep()),
        window_(static_cast<std::size_t>(std::max(kWindowRows, kWindowSteps * stamps.RowsPerStep()))) {}

  /// Nothing if they lie about none.
  std::optional<EvenRows> Find() {
    SplitAtBreaks();
    FirstPeriod();
    if (!(period_ > 0)) return std::nullopt;
    for (int round = 0; round < 2; ++round) CorrectPeriod();
    SplitWhereRowsAreMissing();
    if (static_cast<double>(spans_.size()) > 1 + kLargestShareOfBreaks * static_cast<double>(windows_))
      return std::nullopt;
    PeriodOfAll();
    EvenRows rows;
    rows.period = period_;
    const double spread = SpreadOfWindows();
    for (const Span& span : spans_) {
      double sum = 0, low = kInfinity, high = -kInfinity;
      for (std::size_t k = span.begin; k < span.end; ++k) {
        const double off = t_[k] - period_ * static_cast<double>(k - span.begin);
        sum += off;
        low = std::min(low, off);
        high = std::max(high, off);
      }
      if (high - low > kOffTheLine * spread + period_) return std::nullopt;
      rows.pieces.push_back(
          {static_cast<std::int64_t>(span.begin), sum / static_cast<double>(span.end - span.begin)});
    }
    for (std::size_t k = 1; k < rows.pieces.size(); ++k)
      rows.pieces[k].time =
          std::max(rows.pieces[k].time,
                   rows.pieces[k - 1].time +
                       period_ * static_cast<double>(rows.pieces[k].first - rows.pieces[k - 1].first));
    return rows;
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

  void FirstPeriod() {
    period_ = 0;
    const auto rows = static_cast<double>(window_);
    windows_ = 0;
    ForWindows([&](const Span&, std::size_t) { ++windows_; });
    if (windows_ < kLeastWindows) return;
    period_ = Median(Wander(), kNaN) / rows;
  }
  void CorrectPeriod() { period_ += Median(Wander(), kNaN) / static_cast<double>(window_); }

  /// Where the phase moves from the window before a window to the one behind it by most of a period or more, rows are missing.
  void SplitWhereRowsAreMissing() {
    std::vector<double> spread;
    for (const double step : Wander()) spread.push_back(std::abs(step));
    const double least =
        std::max(kDisplaced * period_, kDisplacedSpreads * Median(std::move(spread), kNaN) / kMedianAbsolute);
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

  double SpreadOfWindows() const {
    std::vector<double> spreads;
    ForWindows([&](const Span&, std::size_t at) {
      double low = kInfinity, high = -kInfinity;
      for (std::size_t k = at; k < at + window_; ++k) {
        const double off = t_[k] - t_[at] - period_ * static_cast<double>(k - at);
        low = std::min(low, off);
        high = std::max(high, off);
      }
      spreads.push_back(high - low);
    });
    return Median(std::move(spreads), kNaN);
  }

  const std::vector<double>& t_;
  double clock_;  ///< s
  std::size_t window_;
  std::vector<Span> spans_;
  std::size_t windows_ = 0;
  double period_ = 0;  ///< s
};

class EvenReader : public LogReader {
 public:
  EvenReader(std::unique_ptr<LogReader> inner, EvenRows rows)
      : inner_(std::move(inner)), even_(std::move(rows)), check_(even_.period) {
    const Told& before = inner_->counters().time_base;
    if (!before.empty()) even_.why = Tell("{}; {}", "{}; {}", before, even_.why);
    counters_.time_base = even_.why;
  }

  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    const auto read = inner_->Read(block, max_rows);
    for (std::size_t row = 0; row < block.rows(); ++row, ++next_) {
      while (piece_ + 1 < even_.pieces.size() && next_ >= even_.pieces[piece_ + 1].first) ++piece_;
      const EvenRows::Piece& piece = even_.pieces[piece_];
      block.time[row] = piece.time + even_.period * static_cast<double>(next_ - piece.first);
      for (auto& flags : block.quality) flags[row] &= static_cast<Quality>(~kOfTheTime);
    }
    check_.Check(block, of_time_);
    counters_ = WithFlagsOfTime(inner_->counters(), of_time_);
    counters_.time_base = even_.why;
    return read;
  }
  double Progress() const override { return inner_->Progress(); }
  double SamplePeriod() const override { return even_.period; }
  const LogCounters& counters() const override { return counters_; }

 private:
  std::unique_ptr<LogReader> inner_;
  EvenRows even_;
  TimeChecker check_;
  LogCounters counters_, of_time_;
  std::int64_t next_ = 0;  ///< row
  std::size_t piece_ = 0;
};

Told WhyOf(const Stamps& stamps, bool coarse, double period) {
  const double ms = 1e3 * period, rate = 1 / period;
  if (coarse)
    return Tell(
        "{:.3g} % of the rows repeat the time stamp of the row before; since rows lie along a straight line of {:.5g} ms each "
        "({:.5g} Hz), they are taken as that far apart",
        "{:.3g} % der Zeilen wiederholen den Zeitstempel der Zeile davor; da die Zeilen auf einer Geraden von je {:.5g} ms liegen "
        "({:.5g} Hz), gelten sie als so weit auseinander",
        100 * stamps.RepeatedShare(), ms, rate);
  return Tell(
      "the time stamps tell when a row was stored, not when it was sampled: the signals are smoother over even rows than over the "
      "stamps; rows are taken as {:.5g} ms apart ({:.5g} Hz)",
      "die Zeitstempel sagen, wann eine Zeile gespeichert und nicht wann sie abgetastet wurde: die Signale sind über gleichmäßigen "
      "Zeilen glatter als über den Stempeln; Zeilen gelten als {:.5g} ms auseinander ({:.5g} Hz)",
      ms, rate);
}

}  // namespace

bool MayBeEvenRows(const SampleBlock& head) {
  Stamps stamps;
  stamps.Add(head);
  return stamps.Coarse() || stamps.Jitter();
}

Result<std::optional<EvenRows>> FindEvenRows(LogReader& log) {
  Stamps stamps;
  SampleBlock block;
  for (;;) {
    const auto rows = log.Read(block, kRowsAtOnce);
    if (!rows) return tl::unexpected(rows.error());
    if (*rows == 0) break;
    stamps.Add(block);
    if (stamps.times().size() > kMostRows) return std::nullopt;
  }
  const bool coarse = stamps.Coarse();
  if (!coarse && !(stamps.Jitter() && stamps.SmootherOverRows())) return std::nullopt;
  auto rows = LineThroughStamps(stamps).Find();
  if (rows) rows->why = WhyOf(stamps, coarse, rows->period);
  return rows;
}

std::unique_ptr<LogReader> WithEvenTimes(std::unique_ptr<LogReader> reader, EvenRows rows) {
  return std::make_unique<EvenReader>(std::move(reader), std::move(rows));
}

}  // namespace hydroscope
