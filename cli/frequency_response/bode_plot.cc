#include "cli/frequency_response/bode_plot.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/constants.h"
#include "report/svg_sheet.h"

namespace hydroscope {
namespace {

constexpr double kWidth = 700, kHeight = 270;
constexpr int kCurvePoints = 200;
const double kDecibels = 20 / std::numbers::ln10;

/// Gain or phase over frequency: values with the halves of their intervals, and a curve.
struct BodePanel {
  std::vector<double> f, value, half, curve_f, curve;

  SvgPlot Plot(const std::string& label, const std::string& unit, double level, bool with_frequency) const {
    SvgPlot::Options options;
    options.width = kWidth;
    options.height = kHeight;
    options.title = options.y_label = label;
    options.x_label = with_frequency ? "frequency (Hz)" : "";
    options.x_tick_labels = with_frequency;
    options.log_x = true;
    SvgPlot plot(options);
    std::vector<double> low, high;
    std::vector<std::string> titles;
    for (std::size_t k = 0; k < f.size(); ++k) {
      low.push_back(value[k] - half[k]);
      high.push_back(value[k] + half[k]);
      titles.push_back(fmt::format("{:.5g} Hz: {:.4g} ± {:.2g}{}", f[k], value[k], half[k], unit));
    }
    plot.Level(level, {Ink::kNeutral, Dash::kDashed, 1}, "");
    plot.ErrorBars(f, low, high, Ink::kBlue);
    plot.Points(f, value, {Ink::kBlue, Marker::kCircle, 3, false}, "", titles);
    plot.Line(curve_f, curve, {Ink::kVermillion, Dash::kSolid, 1.8}, "");
    return plot;
  }
};

}  // namespace

double Decibels(double gain) { return 20 * std::log10(gain); }

std::string BodePlot(const BodePicture& picture) {
  BodePanel gain, phase;
  for (const FrequencyPoint* p : picture.points) {
    gain.f.push_back(p->frequency);
    gain.value.push_back(Decibels(p->gain()));
    gain.half.push_back(kNormal95 * p->GainStd() / p->gain() * kDecibels);
    phase.value.push_back(p->phase * kDegrees);
    phase.half.push_back(kNormal95 * p->PhaseStd() * kDegrees);
  }
  phase.f = gain.f;
  const double lowest = gain.f.front(), highest = gain.f.back();
  for (int i = 0; picture.response && i <= kCurvePoints; ++i) {
    const double f = lowest * std::pow(highest / lowest, static_cast<double>(i) / kCurvePoints);
    gain.curve_f.push_back(f);
    gain.curve.push_back(Decibels(std::abs(picture.response(f))));
    phase.curve.push_back(picture.phase(f) * kDegrees);
  }
  phase.curve_f = gain.curve_f;
  return SvgSheet(picture.title, "points: measured with 95 % bars" + picture.legend,
                  {gain.Plot(picture.gain_label, " dB",
                             picture.gain_level.value_or(gain.value.front() - kHalfPower), false),
                   phase.Plot("phase (°)", "°", -90, true)});
}

}  // namespace hydroscope
