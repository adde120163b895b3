#include "report/svg_plot.h"

#include <utility>

#include "report/svg_render.h"

namespace hydroscope {

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
