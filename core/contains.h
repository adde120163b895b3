#pragma once

#include <algorithm>

namespace hydroscope {

/// Whether one of the elements of `range` equals `value`.
template <typename Range, typename Value>
bool Contains(const Range& range, const Value& value) {
  return std::ranges::find(range, value) != std::ranges::end(range);
}

}  // namespace hydroscope
