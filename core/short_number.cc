#include "core/short_number.h"

#include <fmt/format.h>

#include <cmath>

namespace hydroscope {

std::string AsPeopleRead(std::string written, double value) {
  const std::size_t exponent = written.find("e");
  if (!std::isfinite(value) || exponent == written.npos) return written;
  if (const double size = std::abs(value); size >= 1 && size < 1e6)
    return fmt::format("{}{:.0f}", written.starts_with('+') ? "+" : "", value);
  const int power = std::stoi(written.substr(exponent + 1));
  return fmt::format("{}e{}", written.substr(0, exponent), power);
}

std::string ShortNumber(double value, int digits) {
  return AsPeopleRead(fmt::format("{:.{}g}", value, digits), value);
}

}  // namespace hydroscope
