#include "replay/copied_rows.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "replay/retimed_reader.h"

namespace hydroscope {
namespace {

/// The row before the present one.
class RowBefore {
 public:
  /// Whether a row of `block` has its time stamp, and whether it has all its readings; then that row is the one before.
  struct Likeness {
    bool stamp = false, readings = false;
  };
  Likeness Compare(const SampleBlock& block, std::size_t row) {
    Likeness like{.stamp = block.time[row] == time_, .readings = true};
    time_ = block.time[row];
    values_.resize(block.signal.size(), kNaN);
    for (std::size_t s = 0; s < values_.size(); ++s) {
      const double value = block.signal[s][row];
      like.readings = like.readings && (value == values_[s] || (std::isnan(value) && std::isnan(values_[s])));
      values_[s] = value;
    }
    return like;
  }

 private:
  double time_ = kNaN;  ///< s
  std::vector<double> values_;
};

class OnceReader : public RetimedReader {
 public:
  OnceReader(std::unique_ptr<LogReader> inner, const CopiedRows& copied)
      : RetimedReader(std::move(inner), copied.period, copied.why) {}

 private:
  void Retime(SampleBlock& block) override {
    KeepRows(block, [&](std::size_t row) {
      const auto like = before_.Compare(block, row);
      return !(like.stamp && like.readings);
    });
  }

  RowBefore before_;
};

}  // namespace

std::optional<CopiedRows> FindCopiedRows(const SampleBlock& head) {
  RowBefore before;
  int repeated = 0, copies = 0;
  for (std::size_t row = 0; row < head.rows(); ++row) {
    const auto like = before.Compare(head, row);
    repeated += like.stamp;
    copies += like.stamp && like.readings;
  }
  if (copies == 0 || 2 * copies <= repeated) return std::nullopt;
  CopiedRows copied;
  copied.period = SamplePeriodOf(head.time);
  if (!(copied.period > 0)) return std::nullopt;
  copied.why = Tell(
      "the logger writes one row in {:.3g} twice, stamp and readings; the copies are left out",
      "der Logger schreibt eine von {:.3g} Zeilen doppelt, Stempel und Messwerte; die Kopien bleiben weg",
      static_cast<double>(head.rows() - static_cast<std::size_t>(copies)) / copies);
  return copied;
}

std::unique_ptr<LogReader> WithoutCopiedRows(std::unique_ptr<LogReader> reader, const CopiedRows& copied) {
  return std::make_unique<OnceReader>(std::move(reader), copied);
}

}  // namespace hydroscope
