#include "replay/even_rows.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "replay/copied_rows.h"
#include "replay/retimed_reader.h"
#include "replay/time_check.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsAtOnce = 1000;
constexpr std::size_t kMostRows = 5'000'000;  // whose stamps are remembered, 40 MB
// Steps that differ by more from the middle one, and their share from which on stamps jitter.
constexpr double kUnevenStep = 0.15, kUnevenShare = 0.2;
constexpr double kNoJitter = 5.0;  // middle steps, from which on rows are missing
// Standard deviations by which signals must be smoother over even rows.
constexpr double kSmoother = 6.0;

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
    return repeated_ >= kCoarseShare * rows && copies_ <= kMostlyCopies * repeated_;
  }
  bool Jitter() const {
    const double middle = SamplePeriodOf(times_);
    std::int64_t uneven = 0, steps = 0;
    for (std::size_t k = 1; k < times_.size(); ++k) {
      const double step = times_[k] - times_[k - 1];
      if (!(step >= 0) || step > kNoJitter * middle) continue;
      ++steps;
      uneven += std::abs(step - middle) > kUnevenStep * middle;
    }
    return static_cast<double>(uneven) > kUnevenShare * static_cast<double>(steps);
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
    for (std::size_t s = 0; s < block.signal.size(); ++s) {
      const double value = block.quality[s][row] & quality::kMissing ? kNaN : block.signal[s][row];
      if (step > 0 && next > 0 && next < 3 * step && step < 3 * next)
        smooth_[s].Add(before_[s], at_[s], value, step, next);
      before_[s] = at_[s];
      at_[s] = value;
    }
    const auto like = before_row_.Compare(block, row);
    repeated_ += like.stamp;
    copies_ += like.copy;
    times_.push_back(t);
  }

  std::vector<double> times_;  ///< s
  RowBefore before_row_;
  std::vector<double> before_, at_;   ///< values of the last two rows
  std::vector<Smoothness> smooth_;    ///< per channel
  double repeated_ = 0, copies_ = 0;  ///< rows with the stamp of the row before; those with its values too
};

class EvenReader : public RetimedReader {
 public:
  EvenReader(std::unique_ptr<LogReader> inner, EvenRows rows)
      : RetimedReader(std::move(inner), rows.period, rows.why), even_(std::move(rows)) {}

 private:
  void Retime(SampleBlock& block) override {
    for (double& time : block.time) {
      while (piece_ + 1 < even_.pieces.size() && next_ >= even_.pieces[piece_ + 1].first) ++piece_;
      const StampLine::Piece& piece = even_.pieces[piece_];
      time = piece.time + even_.period * static_cast<double>(next_++ - piece.first);
    }
  }

  EvenRows even_;
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
    const auto rows = TRY(log.Read(block, kRowsAtOnce));
    if (rows == 0) break;
    stamps.Add(block);
    if (stamps.times().size() > kMostRows) return std::nullopt;
  }
  const bool coarse = stamps.Coarse();
  if (!coarse && !(stamps.Jitter() && stamps.SmootherOverRows())) return std::nullopt;
  const auto line = LineThrough(stamps.times());
  if (!line) return std::nullopt;
  return EvenRows{*line, WhyOf(stamps, coarse, line->period)};
}

std::unique_ptr<LogReader> WithEvenTimes(std::unique_ptr<LogReader> reader, EvenRows rows) {
  return std::make_unique<EvenReader>(std::move(reader), std::move(rows));
}

}  // namespace hydroscope
