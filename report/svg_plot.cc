#include "report/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/svg_render.h"
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

SvgPlot::SvgPlot(Options options) : options_(std::move(options)) {}

void SvgPlot::Band(std::vector<double> x, std::vector<double> low, std::vector<double> high, Ink ink,
                   std::string label) {
  layers_.emplace_back(BandLayer{std::move(x), std::move(low), std::move(high), ink, std::move(label)});
}

void SvgPlot::Line(std::vector<double> x, std::vector<double> y, LineStyle style, std::string label) {
  layers_.emplace_back(LineLayer{std::move(x), std::move(y), style, std::move(label)});
}

void SvgPlot::Points(std::vector<double> x, std::vector<double> y, PointStyle style, std::string label,
                     std::vector<std::string> titles) {
  layers_.emplace_back(PointLayer{std::move(x), std::move(y), style, std::move(label), std::move(titles)});
}

void SvgPlot::ErrorBars(std::vector<double> x, std::vector<double> low, std::vector<double> high, Ink ink) {
  layers_.emplace_back(ErrorLayer{std::move(x), std::move(low), std::move(high), ink});
}

void SvgPlot::Level(double y, LineStyle style, std::string label) {
  layers_.emplace_back(LevelLayer{y, style, std::move(label)});
}

void SvgPlot::Borders(std::vector<double> x) { layers_.emplace_back(BorderLayer{std::move(x)}); }

void SvgPlot::HeatMap(std::vector<double> x_edges, std::vector<double> y_edges, std::vector<double> values,
                      bool diverging, std::string value_label) {
  layers_.emplace_back(HeatLayer{std::move(x_edges), std::move(y_edges), std::move(values), diverging,
                                 std::move(value_label)});
}

std::string SvgPlot::Render() const { return RenderPlot(options_, layers_); }

std::string PlotStyleSheet() {
  return R"css(
:root{--p-blue:#0072b2;--p-vermillion:#c95400;--p-green:#00845f;--p-orange:#b87800;--p-purple:#a8508a;--p-sky:#2f8fc4;
--p-neutral:#5b6470;--p-ink:#1d2329;--p-grid:#e3e7eb;--p-axis:#8b95a1;--p-paper:#ffffff}
@media (prefers-color-scheme:dark){:root:not([data-theme=light]){--p-blue:#56b4e9;--p-vermillion:#f5854a;--p-green:#2cc79a;
--p-orange:#e9b13a;--p-purple:#dd98c2;--p-sky:#8ecff2;--p-neutral:#a3adb8;--p-ink:#e4e8ec;--p-grid:#2c333b;--p-axis:#77828e;
--p-paper:#191e24}}
:root[data-theme=dark]{--p-blue:#56b4e9;--p-vermillion:#f5854a;--p-green:#2cc79a;--p-orange:#e9b13a;--p-purple:#dd98c2;
--p-sky:#8ecff2;--p-neutral:#a3adb8;--p-ink:#e4e8ec;--p-grid:#2c333b;--p-axis:#77828e;--p-paper:#191e24}
@media print{:root,:root[data-theme=dark],:root:not([data-theme=light]){--p-blue:#0072b2;--p-vermillion:#c95400;
--p-green:#00845f;--p-orange:#b87800;--p-purple:#a8508a;--p-sky:#2f8fc4;--p-neutral:#5b6470;--p-ink:#1d2329;
--p-grid:#e3e7eb;--p-axis:#8b95a1;--p-paper:#ffffff}}
.p-plot{display:block;width:100%;height:auto;font:12.5px system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;fill:var(--p-ink)}
.p-plot text{font-variant-numeric:tabular-nums}
.p-grid{stroke:var(--p-grid);stroke-width:1;fill:none}
.p-frame{stroke:var(--p-axis);stroke-width:1;fill:none}
.p-border{stroke:var(--p-axis);stroke-width:.8;stroke-dasharray:1 3;fill:none}
.p-tick{fill:var(--p-neutral);font-size:12px}
.p-label{fill:var(--p-ink);font-weight:600;font-size:12.5px}
.p-note{font-size:11.5px;paint-order:stroke;stroke:var(--p-paper);stroke-width:3.5px;stroke-linejoin:round}
.p-empty{fill:var(--p-neutral);font-style:italic}
.p-line{fill:none;stroke-linejoin:round;stroke-linecap:round}
.p-fill{stroke:none;fill-opacity:.2}
.p-hollow{fill:var(--p-paper)}
.p-blank{fill:var(--p-grid)}
.p-blue{--c:var(--p-blue)}.p-vermillion{--c:var(--p-vermillion)}.p-green{--c:var(--p-green)}.p-orange{--c:var(--p-orange)}
.p-purple{--c:var(--p-purple)}.p-sky{--c:var(--p-sky)}.p-neutral{--c:var(--p-neutral)}
.p-line,.p-mark{stroke:var(--c)}.p-fill,.p-solid,.p-note{fill:var(--c)}
.p-mark{stroke-width:1.3}
)css";
}

}  // namespace hydroscope
