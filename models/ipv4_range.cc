#include "models/ipv4_range.h"

#include <charconv>
#include <string_view>

namespace hydroscope {
namespace {

/// A number from 0 to `most` at the beginning of `text`, which loses it.
std::optional<std::uint32_t> TakeNumber(std::string_view& text, std::uint32_t most) {
  std::uint32_t number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || number > most) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
  return number;
}

bool TakeCharacter(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::optional<Ipv4Range> ParseIpv4Range(const std::string& text) {
  std::string_view rest = text;
  Ipv4Range range;
  for (int byte = 0; byte < 4; ++byte) {
    if (byte > 0 && !TakeCharacter(rest, '.')) return std::nullopt;
    const auto number = TakeNumber(rest, 255);
    if (!number) return std::nullopt;
    range.network = range.network << 8 | *number;
  }
  std::uint32_t bits = 32;
  if (TakeCharacter(rest, '/')) {
    const auto prefix = TakeNumber(rest, 32);
    if (!prefix) return std::nullopt;
    bits = *prefix;
  }
  range.mask = bits == 0 ? 0 : ~std::uint32_t{0} << (32 - bits);
  if (!rest.empty() || (range.network & ~range.mask) != 0) return std::nullopt;
  return range;
}

}  // namespace hydroscope
