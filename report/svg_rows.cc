#include "report/svg_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/svg_marks.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

constexpr double kRowHeight = 26, kTop = 24, kAxis = 42, kBar = 13;

std::string Text(double x, double y, const char* anchor, const char* classes, const std::string& text) {
  return fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"{}\" class=\"{}\">{}</text>", Px(x), Px(y),
                     anchor, classes, SvgSymbol(text));
}

AxisRange RangeOf(const RowPlot& plot) {
  double low = plot.bars ? 0 : INFINITY, high = plot.bars ? 0 : -INFINITY;
  const auto add = [&](double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const PlotRow& row : plot.rows)
    for (const double value : {row.value, row.low, row.high}) add(value);
  if (plot.level) add(*plot.level);
  if (low > high) return {0, 1};
  const AxisRange range = PaddedRange(low, high, 0.04);
  return plot.bars ? AxisRange{0, range.high} : range;
}

}  // namespace

std::string RenderRows(const RowPlot& plot) {
  const AxisRange range = RangeOf(plot);
  const double left = plot.label_width, right = plot.width - plot.note_width;
  const double bottom = kTop + kRowHeight * static_cast<double>(plot.rows.size());
  const auto x = [&](double value) {
    const double share = (value - range.low) / (range.high - range.low);
    return left + std::clamp(share, 0.0, 1.0) * (right - left);
  };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"p-plot\" viewBox=\"0 0 {} {}\" role=\"img\" "
      "aria-label=\"{}\">",
      Px(plot.width), Px(bottom + kAxis), EscapeText(PlainSymbol(plot.title)));
  svg += "<title>" + EscapeText(PlainSymbol(plot.title)) + "</title>";
  const AxisTicks ticks =
      NiceTicks(range.low, range.high, std::clamp(static_cast<int>((right - left) / 80), 2, 10));
  std::string grid;
  for (const double tick : ticks.values) grid += fmt::format("M{} {}V{}", Px(x(tick)), Px(kTop), Px(bottom));
  svg += fmt::format("<path class=\"p-grid\" d=\"{}\"/><path class=\"p-frame\" d=\"M{} {}V{}H{}\"/>", grid,
                     Px(left), Px(kTop), Px(bottom), Px(right));
  for (std::size_t i = 0; i < ticks.values.size(); ++i)
    svg += Text(x(ticks.values[i]), bottom + 17, "middle", "p-tick", ticks.labels[i]);
  svg += Text((left + right) / 2, bottom + 36, "middle", "p-label",
              plot.x_label + (ticks.exponent ? " × " + PowerOfTen(ticks.exponent) : ""));
  for (std::size_t k = 0; k < plot.rows.size(); ++k) {
    const PlotRow& row = plot.rows[k];
    const double y = kTop + kRowHeight * (static_cast<double>(k) + 0.5);
    svg += Text(left - 8, y + 4, "end", row.bold ? "p-label" : "", row.label);
    if (std::isfinite(row.value) && plot.bars)
      svg += fmt::format(
          "<rect class=\"p-solid {}\" fill-opacity=\".75\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
          InkClass(row.ink), Px(left), Px(y - kBar / 2), Px(std::max(0.5, x(row.value) - left)), Px(kBar));
    if (row.low < row.high)
      svg += fmt::format(
          "<path class=\"p-line {0}\" stroke-width=\"1.6\" d=\"M{1} {2}H{3}M{1} {4}v8M{3} {4}v8\"/>",
          InkClass(row.ink), Px(x(row.low)), Px(y), Px(x(row.high)), Px(y - 4));
    if (std::isfinite(row.value) && !plot.bars) {
      const PointStyle style{row.ink, row.bold ? Marker::kDiamond : Marker::kCircle, row.bold ? 4.5 : 3.5,
                             false};
      svg += fmt::format("<path class=\"{}\" d=\"{}\"/>", PointClass(style),
                         MarkerPath(style.marker, x(row.value), y, style.radius));
    }
    svg += Text(right + 10, y + 4, "start", "p-tick", row.note);
  }
  if (plot.level) {
    svg += fmt::format(
        "<path class=\"p-line p-neutral\" stroke-width=\"1.6\" stroke-dasharray=\"5 3\" d=\"M{} {}V{}\"/>",
        Px(x(*plot.level)), Px(kTop - 4), Px(bottom));
    svg += Text(x(*plot.level), kTop - 9, x(*plot.level) > (left + right) / 2 ? "end" : "start",
                "p-note p-neutral", plot.level_label);
  }
  return svg + "</svg>\n";
}

}  // namespace hydroscope
