#include "core/json_text.h"

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/printable.h"

namespace hydroscope {
namespace {

/// The character at the beginning of well-formed UTF-8 that JSON lets stand and a terminal obeys, and its bytes; 0 bytes: none.
struct Control {
  std::uint32_t code = 0;
  std::size_t bytes = 0;
};
Control ControlAt(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) == 0x7f) return {0x7f, 1};
  if (byte(0) == 0xc2 && byte(1) < 0xa0) return {byte(1), 2};  // U+0080 ... U+009F
  if (DirectionMark(text) > 0) return {0x2000u | (byte(1) & 0x3fu) << 6 | (byte(2) & 0x3fu), 3};
  return {};
}

}  // namespace

std::string JsonText(const nlohmann::json& document, int indent) {
  const std::string text = document.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string out;
  std::size_t kept = 0;  // bytes of `text` that stand in `out`
  for (std::size_t at = 0; at < text.size(); ++at) {
    const Control control = ControlAt(std::string_view(text).substr(at));
    if (control.bytes == 0) continue;
    out.append(text, kept, at - kept).append(fmt::format("\\u{:04x}", control.code));
    kept = at + control.bytes;
    at = kept - 1;
  }
  return kept == 0 ? text : out.append(text, kept);
}

}  // namespace hydroscope
