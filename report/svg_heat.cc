#include "report/svg_heat.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/svg_marks.h"
#include "report/svg_text.h"

namespace hydroscope {

AxisRange HeatRange(const SvgPlot::HeatLayer& layer) {
  double low = INFINITY, high = -INFINITY;
  for (const double value : layer.values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (low > high) return {0, 1};
  if (!layer.diverging) return PaddedRange(low, high, 0);
  const double most = std::max({std::abs(low), std::abs(high), 1e-300});
  return {-most, most};
}

std::string HeatColour(double share, bool diverging) {
  static constexpr int kSequential[5][3] = {
      {0, 34, 78}, {65, 77, 107}, {124, 123, 120}, {188, 175, 111}, {254, 232, 56}};
  static constexpr int kDiverging[5][3] = {
      {0, 90, 150}, {110, 170, 210}, {235, 235, 235}, {240, 165, 115}, {200, 80, 0}};
  const auto& stations = diverging ? kDiverging : kSequential;
  const double position = std::clamp(share, 0.0, 1.0) * 4;
  const int k = std::min(static_cast<int>(position), 3);
  int rgb[3];
  for (int c = 0; c < 3; ++c)
    rgb[c] = static_cast<int>(
        std::lround(stations[k][c] + (position - k) * (stations[k + 1][c] - stations[k][c])));
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

std::string HeatScale(const SvgPlot::HeatLayer& layer, double x, double top, double bottom, double width) {
  const AxisRange range = HeatRange(layer);
  const double height = bottom - top;
  std::string scale;
  for (int k = 0; k < 40; ++k)
    scale += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"12\" height=\"{}\" fill=\"{}\"/>", Px(x),
                         Px(bottom - (k + 1) * height / 40), Px(height / 40 + 0.4),
                         HeatColour((k + 0.5) / 40, layer.diverging));
  const AxisTicks ticks = NiceTicks(range.low, range.high, 4);
  for (std::size_t i = 0; i < ticks.values.size(); ++i)
    scale += fmt::format("<text x=\"{}\" y=\"{}\" class=\"p-tick\">{}</text>", Px(x + 17),
                         Px(bottom - (ticks.values[i] - range.low) / (range.high - range.low) * height + 4),
                         ticks.labels[i]);
  const std::string name = layer.label + (ticks.exponent ? " × " + PowerOfTen(ticks.exponent) : "");
  scale += fmt::format("<text x=\"{}\" y=\"13\" text-anchor=\"end\" class=\"p-label\">{}</text>",
                       Px(width - 4), SvgSymbol(name));
  return scale;
}

}  // namespace hydroscope
