#include "core/interval_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/effect_units.h"
#include "core/short_number.h"
#include "core/units.h"

namespace hydroscope {

namespace {

/// Sizes outside would be a row of zeros, before or behind the point.
bool ReadsWithoutExponent(double size) { return size == 0 || (size >= 1e-4 && size < 1e7); }

/// No "-0" where the digits shown are all zero.
std::string Fixed(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  const bool zero = std::isfinite(value) && text.find_first_of("123456789") == std::string::npos;
  return zero ? fmt::format("{:.{}f}", 0.0, decimals) : text;
}

}  // namespace

std::string WithInterval(double value, double half_width) {
  if (!std::isfinite(half_width)) return ShortNumber(value, 4) + " ± ?";
  if (const double size = std::max(std::abs(value), std::abs(half_width));
      std::isfinite(size) && !ReadsWithoutExponent(size)) {
    const int exponent = static_cast<int>(std::floor(std::log10(size)));
    const double scale = std::pow(10.0, exponent);
    return fmt::format("({})e{}", WithInterval(value / scale, half_width / scale), exponent);
  }
  const double leading = std::max(std::abs(half_width), 1e-4 * std::abs(value));
  const int decimals =
      leading > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(leading))), 0, 9) : 0;
  const std::string half = Fixed(half_width, decimals);
  const bool vanishes = half_width != 0 && half.find_first_of("123456789") == std::string::npos;
  return fmt::format("{} ± {}", Fixed(value, decimals), vanishes ? ShortNumber(half_width, 1) : half);
}

std::string FoundWithInterval(double value, double half_width) {
  const bool swallowed = value != 0 && std::isfinite(half_width) && std::abs(value) < std::abs(half_width);
  return swallowed ? ShortNumber(value) + " ± " + ShortNumber(half_width, 2)
                   : WithInterval(value, half_width);
}

std::string ChangeWithInterval(double change, double half_width) {
  return (change > 0 ? "+" : "") + WithInterval(change, half_width);
}

int DigitsFor(double value, double half_width) {
  constexpr int kFewest = 5, kMost = 9;
  const double orders = std::log10(std::abs(value) / half_width);
  return std::isfinite(orders) ? std::clamp(static_cast<int>(std::ceil(orders)) + 2, kFewest, kMost)
                               : kFewest;
}

std::string ShownWithInterval(double value, double std, const std::string& si_unit) {
  const EffectUnit unit = EffectUnitFor(si_unit);
  const double offset = DisplayUnitFor(si_unit).offset;
  return WithInterval(value * unit.factor + offset, kNormal95 * std * unit.factor) +
         (unit.name == "-" ? "" : " " + unit.name);
}

}  // namespace hydroscope
