#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cli/bode_plot.h"
#include "cli/frf_report.h"
#include "core/constants.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

constexpr double kWidth = 720, kHeight = 600, kLeft = 72, kRight = 700;

constexpr const char* kStyle = R"(<style>
svg{color-scheme:light dark;--ink:#1a1f26;--soft:#5b6673;--grid:#d9dee4;--paper:#ffffff;--point:#0060a8;--model:#b34700}
@media (prefers-color-scheme:dark){svg{--ink:#e8ecf0;--soft:#a3afbb;--grid:#343c45;--paper:#14181d;--point:#62b5f5;--model:#ff9a52}}
text{font:13px system-ui,sans-serif;fill:var(--ink)}.soft{fill:var(--soft)}.head{font-size:15px;font-weight:600}
.paper{fill:var(--paper)}.grid{stroke:var(--grid);stroke-width:1}.frame{fill:none;stroke:var(--soft)}
.bar{stroke:var(--point);stroke-width:1.4}.point{fill:var(--point)}.model{fill:none;stroke:var(--model);stroke-width:1.8}
.level{stroke:var(--soft);stroke-dasharray:5 4}
</style>
)";

struct Mark {
  double frequency, value, half;  // half: 95 % interval
};

struct Panel {
  double top, bottom;  // px
  double low, high;    // of the value
  double f_low, f_high;
  double X(double f) const {
    return kLeft + (kRight - kLeft) * std::log(f / f_low) / std::log(f_high / f_low);
  }
  double Y(double v) const {
    return bottom - (bottom - top) *
                        (std::clamp(v, low - 0.05 * (high - low), high + 0.05 * (high - low)) - low) /
                        (high - low);
  }
};

/// Step of 1, 2 or 5 times a power of ten that gives at most `most` intervals.
double NiceStep(double span, int most) {
  const double raw = span / most, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10 * power;
}

void FitRange(Panel& panel, const std::vector<Mark>& marks, const std::vector<Mark>& curve,
              double step_limit) {
  double low = 1e300, high = -1e300;
  for (const Mark& m : marks) low = std::min(low, m.value), high = std::max(high, m.value);
  for (const Mark& m : curve) low = std::min(low, m.value), high = std::max(high, m.value);
  const double step = std::max(step_limit, NiceStep(std::max(high - low, 1e-9), 6));
  panel.low = std::floor(low / step - 0.1) * step;
  panel.high = std::ceil(high / step + 0.1) * step;
}

std::string FrequencyGrid(const Panel& panel, bool labels) {
  std::string svg;
  const bool narrow = panel.f_high / panel.f_low < 30;
  for (double decade = std::pow(10, std::floor(std::log10(panel.f_low))); decade <= panel.f_high;
       decade *= 10) {
    for (int digit = 1; digit < 10; ++digit) {
      const double f = decade * digit;
      if (f < panel.f_low * 0.999 || f > panel.f_high * 1.001) continue;
      const double x = panel.X(f);
      svg += fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>\n", x,
                         panel.top, panel.bottom);
      if (labels && (digit == 1 || digit == 2 || digit == 5 || (narrow && digit < 9 && digit != 7))) {
        svg += fmt::format("<text class=\"soft\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{:g}</text>\n",
                           x, panel.bottom + 18, f);
      }
    }
  }
  return svg;
}

std::string ValueGrid(const Panel& panel, double step_limit) {
  const double step = std::max(step_limit, NiceStep(panel.high - panel.low, 7));
  std::string svg;
  for (double v = std::ceil(panel.low / step - 1e-9) * step; v <= panel.high + 1e-9 * step; v += step) {
    const double shown = std::abs(v) < 1e-9 * step ? 0 : v;
    svg += fmt::format("<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>\n", kLeft,
                       kRight, panel.Y(v));
    svg += fmt::format("<text class=\"soft\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:g}</text>\n",
                       kLeft - 8, panel.Y(v) + 4, shown);
  }
  return svg;
}

std::string Draw(const Panel& panel, const std::vector<Mark>& marks, const std::vector<Mark>& curve,
                 double level, const std::string& label, double step_limit, bool frequency_labels) {
  std::string svg = FrequencyGrid(panel, frequency_labels) + ValueGrid(panel, step_limit);
  svg += fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", kLeft,
                     panel.top, kRight - kLeft, panel.bottom - panel.top);
  svg += fmt::format(
      "<text x=\"16\" y=\"{0}\" transform=\"rotate(-90 16 {0})\" text-anchor=\"middle\">{1}</text>\n",
      (panel.top + panel.bottom) / 2, label);
  if (level > panel.low && level < panel.high) {
    svg += fmt::format("<line class=\"level\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>\n", kLeft,
                       kRight, panel.Y(level));
  }
  if (!curve.empty()) {
    svg += "<polyline class=\"model\" points=\"";
    for (const Mark& m : curve) svg += fmt::format("{:.1f},{:.1f} ", panel.X(m.frequency), panel.Y(m.value));
    svg += "\"/>\n";
  }
  for (const Mark& m : marks) {
    const double x = panel.X(m.frequency);
    svg += fmt::format("<line class=\"bar\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>", x,
                       panel.Y(m.value - m.half), panel.Y(m.value + m.half));
    svg += fmt::format(
        "<circle class=\"point\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"><title>{:.5g} Hz: {:.4g} ± "
        "{:.2g}</title></circle>\n",
        x, panel.Y(m.value), m.frequency, m.value, m.half);
  }
  return svg;
}

}  // namespace

std::string BodePlot(const BodePicture& picture) {
  std::vector<Mark> gain, phase, model_gain, model_phase;
  for (const FrequencyPoint* p : picture.points) {
    gain.push_back({p->frequency, 20 * std::log10(p->gain()),
                    kNormal95 * p->GainStd() / p->gain() * 20 / std::numbers::ln10});
    phase.push_back({p->frequency, p->phase * kDegrees, kNormal95 * p->PhaseStd() * kDegrees});
  }
  Panel top{64, 300, 0, 0, gain.front().frequency / 1.15, gain.back().frequency * 1.15};
  Panel bottom{324, 546, 0, 0, top.f_low, top.f_high};
  for (int i = 0; picture.response && i <= 200; ++i) {
    const double f = top.f_low * std::pow(top.f_high / top.f_low, i / 200.0);
    model_gain.push_back({f, 20 * std::log10(std::abs(picture.response(f))), 0});
    model_phase.push_back({f, picture.phase(f) * kDegrees, 0});
  }
  FitRange(top, gain, model_gain, 0.5);
  FitRange(bottom, phase, model_phase, 15);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "role=\"img\" aria-label=\"{2}\">\n<title>{2}</title>\n",
      kWidth, kHeight, EscapeText(picture.title));
  svg += kStyle;
  svg += fmt::format(
      "<rect class=\"paper\" width=\"{}\" height=\"{}\"/>\n<text class=\"head\" x=\"{}\" "
      "y=\"26\">{}</text>\n",
      kWidth, kHeight, kLeft, EscapeText(picture.title));
  svg += fmt::format("<text class=\"soft\" x=\"{}\" y=\"48\">points: measured with 95 % bars{}</text>\n",
                     kLeft, picture.legend);
  svg += Draw(top, gain, model_gain, picture.gain_level.value_or(gain.front().value - 3.0103),
              picture.gain_label, 0.5, false);
  svg += Draw(bottom, phase, model_phase, -90, "phase (°)", 15, true);
  svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">frequency (Hz)</text>\n</svg>\n",
                     (kLeft + kRight) / 2, kHeight - 14);
  return svg;
}

std::string FrfBodePlot(const FrequencyResponse& response, const std::string& title) {
  BodePicture picture{.title = title};
  for (const FrequencyPoint& p : response.points)
    if (p.reason == PointReason::kUsed) picture.points.push_back(&p);
  if (response.model) {
    const ValveModel& model = *response.model;
    picture.response = [&model](double f) { return model.Response(f); };
    picture.phase = [&model](double f) { return model.Phase(f); };
    picture.gain_level = 20 * std::log10(std::abs(model.gain.value)) - 3.0103;
    picture.legend =
        fmt::format(" — curve: f0 {:.4g} Hz, D {:.3g}, dead time {:.3f} ms", model.natural_frequency.value,
                    model.damping.value, 1e3 * model.dead_time.value + 0.0);
  }
  return BodePlot(picture);
}

}  // namespace hydroscope
