#include "replay/copied_rows.h"

#include <cmath>

#include "replay/retimed_reader.h"

namespace hydroscope {
namespace {

class OnceReader : public RetimedReader {
 public:
  OnceReader(std::unique_ptr<LogReader> inner, const CopiedRows& copied)
      : RetimedReader(std::move(inner), copied.period, copied.why) {}

 private:
  void Retime(SampleBlock& block) override {
    KeepRows(block, [&](std::size_t row) { return !before_.Compare(block, row).copy; });
  }

  RowBefore before_;
};

}  // namespace

RowBefore::Likeness RowBefore::Compare(const SampleBlock& block, std::size_t row) {
  const bool stamp = block.time[row] == time_;
  bool readings = true;
  time_ = block.time[row];
  values_.resize(block.signal.size(), kNaN);
  for (std::size_t s = 0; s < values_.size(); ++s) {
    const double value = block.signal[s][row];
    readings = readings && (value == values_[s] || (std::isnan(value) && std::isnan(values_[s])));
    values_[s] = value;
  }
  return {stamp, stamp && readings};
}

std::optional<CopiedRows> FindCopiedRows(const SampleBlock& head) {
  RowBefore before;
  int repeated = 0, copies = 0;
  for (std::size_t row = 0; row < head.rows(); ++row) {
    const auto like = before.Compare(head, row);
    repeated += like.stamp;
    copies += like.copy;
  }
  if (copies <= kMostlyCopies * repeated) return std::nullopt;
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
