#include "acquisition/sequence_monitor.h"

#include <algorithm>

namespace hydroscope {

SequenceMonitor::Verdict SequenceMonitor::Receive(std::uint64_t first, std::uint64_t rows) {
  Verdict verdict;
  const std::uint64_t end = first + rows;
  if (!begun_) next_ = first;
  begun_ = true;
  if (first >= next_) {
    verdict.missing = first - next_;
    if (verdict.missing > 0) holes_[next_] = first;
    if (holes_.size() > kHolesKept) holes_.erase(holes_.begin());
    lost_ += static_cast<std::int64_t>(verdict.missing);
    next_ = end;
    return verdict;
  }
  if (Lacks(first)) {
    const auto hole = std::prev(holes_.upper_bound(first));
    const auto [begin, behind] = *hole;
    const std::uint64_t filled = std::min(end, behind);
    holes_.erase(hole);
    if (begin < first) holes_[begin] = first;
    if (filled < behind) holes_[filled] = behind;
    verdict.reordered = true;
    lost_ -= static_cast<std::int64_t>(filled - first);
    duplicates_ += static_cast<std::int64_t>(std::min(end, next_) - filled);  // had come behind the hole
    next_ = std::max(next_, end);
    ++reordered_;
    return verdict;
  }
  verdict.skip = std::min(next_ - first, rows);
  duplicates_ += static_cast<std::int64_t>(verdict.skip);
  next_ = std::max(next_, end);
  return verdict;
}

bool SequenceMonitor::Lacks(std::uint64_t row) const {
  const auto hole = holes_.upper_bound(row);
  return hole != holes_.begin() && std::prev(hole)->second > row;
}

}  // namespace hydroscope
