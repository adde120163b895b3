#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace hydroscope {

/// Bytes of UTF-8 at the beginning of `text` that turn the direction of writing (U+200E, U+200F, U+202A ... U+202E,
/// U+2066 ... U+2069), so that a name reads as another one; 0 if none stands there.
inline std::size_t DirectionMark(std::string_view text) {
  if (text.size() < 3 || text[0] != '\xe2') return 0;
  const auto last = static_cast<unsigned char>(text[2]);
  const bool one = (text[1] == '\x80' && (last == 0x8e || last == 0x8f || (last >= 0xaa && last <= 0xae))) ||
                   (text[1] == '\x81' && last >= 0xa6 && last <= 0xa9);
  return one ? 3 : 0;
}

/// Text that came from outside (a wire, a person) as it may stand on a terminal: control characters, those of
/// ASCII and U+0080 ... U+009F in UTF-8, are written as \xNN, marks of direction as their bytes so, all else stays.
inline std::string Printable(std::string_view text) {
  std::string out;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool c1 = byte(i) == 0xc2 && i + 1 < text.size() && byte(i + 1) >= 0x80 && byte(i + 1) < 0xa0;
    if (DirectionMark(text.substr(i)) > 0) {
      out += fmt::format("\\x{:02x}\\x{:02x}\\x{:02x}", byte(i), byte(i + 1), byte(i + 2));
      i += 2;
    } else if (c1)
      out += fmt::format("\\x{:02x}", byte(++i));
    else if (byte(i) < 0x20 || byte(i) == 0x7f)
      out += fmt::format("\\x{:02x}", byte(i));
    else
      out += text[i];
  }
  return out;
}

/// The same of a text of several lines, whose line ends stay.
inline std::string PrintableLines(std::string_view text) {
  std::string out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    out += Printable(text.substr(begin, end - begin));
    if (end < text.size()) out += '\n';
    begin = end + 1;
  }
  return out;
}

}  // namespace hydroscope
