#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "core/text_encoding.h"

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
/// ASCII and U+0080 ... U+009F in UTF-8, are written as \xNN, so are bytes that are no UTF-8 (a terminal of 8 bits takes some
/// for control characters) and marks of direction; all else stays.
inline std::string Printable(std::string_view text) {
  std::string out;
  const auto write_out = [&](std::string_view bytes) {
    for (const char byte : bytes) out += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
  };
  while (!text.empty()) {
    const std::size_t length = std::max<std::size_t>(Utf8CharacterLength(text), 1);
    const std::string_view character = text.substr(0, length);
    const auto first = static_cast<unsigned char>(character[0]);
    const bool c1 = length == 2 && first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
    const bool control = first < 0x20 || first == 0x7f, alone = length == 1 && first >= 0x80;
    if (c1)
      write_out(character.substr(1));
    else if (control || alone || DirectionMark(character) > 0)
      write_out(character);
    else
      out += character;
    text.remove_prefix(length);
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
