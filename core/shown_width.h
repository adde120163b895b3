#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace hydroscope {

/// Columns of a terminal that a text takes: bytes that go on with a character (UTF-8) do not count.
inline std::size_t ShownWidth(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

/// Widest line that the program prints where it can.
inline constexpr std::size_t kLineWidth = 80;

}  // namespace hydroscope
