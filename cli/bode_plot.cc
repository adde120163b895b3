#include "cli/bode_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "core/constants.h"
#include "estimation/frequency_response/frequency_response.h"
#include "report/svg_sheet.h"
#include "workbench/frequency_response/loop_output.h"

namespace hydroscope {
namespace {

constexpr double kHalfPower = 3.0103;  ///< dB

/// Measured points and a model's curve over frequency.
struct BodePicture {
  std::vector<const FrequencyPoint*> points = {};             ///< in order of frequency, at least one
  std::function<std::complex<double>(double)> response = {};  ///< of Hz; empty: no curve
  std::function<double(double)> phase = {};                   ///< rad, without jumps
  std::optional<double> gain_level = {};  ///< dB, a line across; nothing: 3 dB below the first point
  std::string title = "", legend = "", gain_label = "gain (dB)";
};

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

double Decibels(double gain) { return 20 * std::log10(gain); }

/// As a self-contained SVG that follows the reader's light or dark theme.
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

constexpr std::size_t kPointsShown = 160;  // of a closed loop

}  // namespace

std::string ValveBodePlot(const ValveLog& measured, const std::string& title) {
  BodePicture picture{.points = measured.Used(), .title = title};
  if (measured.response.model) {
    const ValveModel& model = *measured.response.model;
    picture.response = [&model](double f) { return model.Response(f); };
    picture.phase = [&model](double f) { return model.Phase(f); };
    picture.gain_level = Decibels(std::abs(model.gain.value)) - kHalfPower;
    picture.legend =
        fmt::format(" — curve: f0 {:.4g} Hz, D {:.3g}, dead time {:.3f} ms", model.natural_frequency.value,
                    model.damping.value, 1e3 * model.dead_time.value + 0.0);
  }
  return BodePlot(picture);
}

std::string LoopBodePlot(const LoopLog& measured, const std::string& title) {
  const LoopResponse& response = measured.response;
  // What integrates has no level to fall below.
  BodePicture picture{.gain_level = kNaN, .title = title, .gain_label = "gain (dB, SI)"};
  picture.points = UsedPoints(response, kPointsShown);
  if (picture.points.empty())
    for (const FrequencyPoint& p : response.points) picture.points.push_back(&p);
  if (response.fit) {
    const std::vector<double>& parameters = response.fit->parameters;
    picture.response = [&](double f) { return measured.model.Response(f, parameters); };
    picture.phase = [&](double f) {  // as the points: nearest of them
      const auto near = std::ranges::min_element(picture.points, [f](const auto* a, const auto* b) {
        return std::abs(a->frequency - f) < std::abs(b->frequency - f);
      });
      return PhaseBeside(measured.model, parameters, f, **near);
    };
    picture.legend = " — curve: transfer function";
  }
  return BodePlot(picture);
}

}  // namespace hydroscope
