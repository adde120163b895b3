#include "report/svg_axis.h"

#include <algorithm>
#include <cmath>

#include "report/svg_text.h"

namespace hydroscope {
namespace {

/// The nice number nearest to `raw` in ratio.
double NiceStep(double raw) {
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double best = power;
  for (const double factor : {2.0, 2.5, 5.0, 10.0})
    if (std::abs(std::log(factor * power / raw)) < std::abs(std::log(best / raw))) best = factor * power;
  return best;
}

int DecimalsOfStep(double step) {
  for (int decimals = 0; decimals < 9; ++decimals) {
    const double scaled = step * std::pow(10.0, decimals);
    if (std::abs(scaled - std::round(scaled)) < 1e-6 * scaled) return decimals;
  }
  return 9;
}

int CommonExponent(double largest, double step) {
  if (largest < 1e5 && step >= 0.9e-3) return 0;
  return 3 * static_cast<int>(std::floor(std::log10(largest) / 3));
}

}  // namespace

AxisTicks NiceTicks(double low, double high, int target, bool whole) {
  double step = NiceStep((high - low) / std::max(target, 1));
  if (whole) step = step <= 1 ? 1 : (step == 2.5 ? 5 : step);
  AxisTicks ticks;
  ticks.exponent = whole ? 0 : CommonExponent(std::max(std::abs(low), std::abs(high)), step);
  const double unit = std::pow(10.0, ticks.exponent);
  const int decimals = DecimalsOfStep(step / unit);
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  for (double k = first; k <= last && ticks.values.size() < 50; ++k) {
    ticks.values.push_back(k * step);
    ticks.labels.push_back(whole ? FormatCount(std::llround(k * step))
                                 : FormatFixed(k * step / unit, decimals));
  }
  return ticks;
}

AxisTicks DecadeTicks(double low, double high) {
  constexpr double kFewDecades = 30;  // upper over lower end: labels at all digits but those that would touch
  AxisTicks ticks;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high; decade *= 10)
    for (int digit = 1; digit < 10; ++digit) {
      const double value = decade * digit;
      if (value < low || value > high) continue;
      const bool labelled =
          digit == 1 || digit == 2 || digit == 5 || (high < kFewDecades * low && digit != 7 && digit != 9);
      ticks.values.push_back(value);
      ticks.labels.push_back(labelled ? FormatShort(value) : "");
    }
  return ticks;
}

std::string PowerOfTen(int exponent) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
  return text;
}

AxisRange PaddedRange(double low, double high, double share) {
  if (!(low <= high)) return {0, 1};
  double span = high - low;
  const double size = std::max(std::abs(low), std::abs(high));
  if (span <= 1e-9 * size || span == 0) {
    span = size > 0 ? 0.2 * size : 1;
    return {low - span / 2, high + span / 2};
  }
  return {low - share * span, high + share * span};
}

std::vector<std::size_t> DecimateMinMax(const std::vector<double>& y, std::size_t buckets) {
  std::vector<std::size_t> kept;
  if (buckets == 0 || y.size() <= 4 * buckets) {
    kept.resize(y.size());
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = i;
    return kept;
  }
  for (std::size_t b = 0; b < buckets; ++b) {
    const std::size_t begin = b * y.size() / buckets, end = (b + 1) * y.size() / buckets;
    std::vector<std::size_t> finite;
    for (std::size_t i = begin; i < end; ++i)
      if (std::isfinite(y[i])) finite.push_back(i);
    if (finite.empty()) {
      kept.push_back(begin);
      continue;
    }
    const auto [least, greatest] =
        std::ranges::minmax_element(finite, [&](auto a, auto c) { return y[a] < y[c]; });
    std::vector<std::size_t> chosen = {finite.front(), *least, *greatest, finite.back()};
    std::ranges::sort(chosen);
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    kept.insert(kept.end(), chosen.begin(), chosen.end());
  }
  return kept;
}

}  // namespace hydroscope
