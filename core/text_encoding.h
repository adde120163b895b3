#pragma once

#include <string>
#include <string_view>

namespace hydroscope {

/// Bytes of the well-formed UTF-8 character that `text` begins with; 0: it begins with none.
std::size_t Utf8CharacterLength(std::string_view text);

/// Whether every byte belongs to a well-formed UTF-8 character.
bool IsUtf8(std::string_view text);

/// The text in UTF-8: itself where it is UTF-8, else read as ISO-8859-1 (Latin-1), which older loggers write. Bytes 0x80 ...
/// 0x9F are control characters there, and stay such.
std::string ToUtf8(std::string_view text);

}  // namespace hydroscope
