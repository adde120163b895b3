#include "replay/retimed_reader.h"

namespace hydroscope {

RetimedReader::RetimedReader(std::unique_ptr<LogReader> inner, double period, const Told& why)
    : inner_(std::move(inner)), period_(period), check_(period) {
  const Told& before = inner_->counters().time_base;
  counters_.time_base = before.empty() ? why : Tell("{}; {}", "{}; {}", before, why);
}

Result<std::size_t> RetimedReader::Read(SampleBlock& block, std::size_t max_rows) {
  do {
    const auto read = inner_->Read(block, max_rows);
    if (!read || *read == 0) {
      Count();
      return read;
    }
    for (auto& column : block.quality)
      for (Quality& flags : column) flags &= static_cast<Quality>(~kOfTheTime);
    Retime(block);
  } while (block.rows() == 0);
  check_.Check(block, of_time_);
  given_ += static_cast<std::int64_t>(block.rows());
  Count();
  return block.rows();
}

void RetimedReader::Move(std::size_t from, std::size_t to, SampleBlock& block) {
  block.time[to] = block.time[from];
  for (auto& column : block.signal) column[to] = column[from];
  for (auto& column : block.quality) column[to] = column[from];
}

void RetimedReader::Count() {
  Told why = std::move(counters_.time_base);
  counters_ = inner_->counters();
  counters_.rows = given_;
  counters_.time_base = std::move(why);
  for (std::size_t bit = 0; bit < counters_.flagged.size(); ++bit)
    if ((kOfTheTime >> bit) & 1) counters_.flagged[bit] = of_time_.flagged[bit];
}

}  // namespace hydroscope
