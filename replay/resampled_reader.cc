#include "replay/resampled_reader.h"

#include <fmt/format.h>

#include <cmath>

#include "replay/time_check.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRowsBuffered = 1024;
// Own periods between two rows above which nothing lies between them.
constexpr double kNeighbourPeriods = 1.5;

class ResampledReader : public LogReader {
 public:
  ResampledReader(std::unique_ptr<LogReader> inner, double period)
      : inner_(std::move(inner)), period_(period) {}

  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    std::size_t row = 0;
    if (!begun_) {
      if (const auto more = Advance(); !more || !*more)
        return more ? Result<std::size_t>(0) : tl::unexpected(more.error());
    }
    block.Resize(after_.value.size(), max_rows);
    while (row < max_rows && !over_) {
      if (!begun_) {
        BeginAt(block, row++);
      } else if (const double t = origin_ + static_cast<double>(step_) * period_; t <= after_.time) {
        Interpolate(t, block, row++);
        ++step_;
        continue;
      }
      before_ = after_;
      const auto more = Advance();
      if (!more) {
        if (row == 0) return tl::unexpected(more.error());
        break;  // the next call meets the same error
      }
      const double apart = after_.time - before_.time;
      if (*more && !(apart > 0 && apart < kNeighbourPeriods * inner_->SamplePeriod())) begun_ = false;
    }
    block.Resize(after_.value.size(), row);
    Count(row);
    return row;
  }
  double Progress() const override { return inner_->Progress(); }
  double SamplePeriod() const override { return period_; }
  const LogCounters& counters() const override { return counters_; }

 private:
  /// Rows as they are given out, everything else as it was read.
  void Count(std::size_t rows) {
    given_ += static_cast<std::int64_t>(rows);
    counters_ = inner_->counters();
    counters_.rows = given_;
  }

  struct Row {
    double time = 0;
    std::vector<double> value;
    std::vector<Quality> quality;
  };

  /// Reads the next row into `after_`; false at the end of the log.
  Result<bool> Advance() {
    if (next_ == buffer_.rows()) {
      const auto read = TRY(inner_->Read(buffer_, kRowsBuffered));
      next_ = 0;
      over_ = read == 0;
      if (over_) return false;
    }
    after_.time = buffer_.time[next_];
    after_.value.resize(buffer_.signal.size());
    after_.quality.resize(buffer_.signal.size());
    for (std::size_t s = 0; s < after_.value.size(); ++s) {
      after_.value[s] = buffer_.signal[s][next_];
      after_.quality[s] = buffer_.quality[s][next_];
    }
    ++next_;
    return true;
  }

  /// The grid begins with the row `after_`.
  void BeginAt(SampleBlock& block, std::size_t row) {
    begun_ = true;
    origin_ = after_.time;
    step_ = 1;
    block.time[row] = after_.time;
    for (std::size_t s = 0; s < after_.value.size(); ++s) {
      block.signal[s][row] = after_.value[s];
      block.quality[s][row] = after_.quality[s];
    }
  }

  void Interpolate(double t, SampleBlock& block, std::size_t row) {
    const double share = (t - before_.time) / (after_.time - before_.time);
    block.time[row] = t;
    for (std::size_t s = 0; s < after_.value.size(); ++s) {
      block.signal[s][row] = (1 - share) * before_.value[s] + share * after_.value[s];
      block.quality[s][row] = (before_.quality[s] & ~kOfTheTime) | after_.quality[s];
    }
  }

  std::unique_ptr<LogReader> inner_;
  double period_;
  LogCounters counters_;
  std::int64_t given_ = 0;
  SampleBlock buffer_;
  std::size_t next_ = 0;  // row of `buffer_`
  Row before_, after_;
  bool begun_ = false, over_ = false;
  double origin_ = 0;
  std::int64_t step_ = 0;
};

}  // namespace

std::unique_ptr<LogReader> AtPeriod(std::unique_ptr<LogReader> reader, double period, std::string& note) {
  const double own = reader->SamplePeriod(), apart = std::abs(own - period);
  if (!(period > 0) || apart <= kSamePeriod * period || apart > kNearPeriod * period) return reader;
  note = fmt::format(
      "rows {:.4g} ms apart are interpolated to {:.4g} ms, those of the logs before; that takes up to a "
      "third of the sensor noise away",
      1e3 * own, 1e3 * period);
  return std::make_unique<ResampledReader>(std::move(reader), period);
}

}  // namespace hydroscope
