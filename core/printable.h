#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace hydroscope {

/// Text that came from outside (a wire, a person) as it may stand on a terminal: control characters, those of
/// ASCII and U+0080 ... U+009F in UTF-8, are written as \xNN, all else stays.
inline std::string Printable(std::string_view text) {
  std::string out;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool c1 = byte(i) == 0xc2 && i + 1 < text.size() && byte(i + 1) >= 0x80 && byte(i + 1) < 0xa0;
    if (c1)
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
