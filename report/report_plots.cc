#include "report/report_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "core/distributions.h"
#include "core/quantile.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "report/report_page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

/// Range of the estimates with four typical half widths: the first, still wide intervals must not flatten the rest.
AxisRange ValueRange(const std::vector<TrendSample>& samples, const ParameterInfo& info) {
  std::vector<double> half_widths;
  double low = 0, high = 0;
  bool any = false;
  for (const TrendSample& sample : samples) {
    const double shown = info.Shown(sample.value);
    low = any ? std::min(low, shown) : shown;
    high = any ? std::max(high, shown) : shown;
    any = true;
    if (sample.updated && std::isfinite(sample.std))
      half_widths.push_back(kNormal95 * sample.std * std::abs(info.factor));
  }
  const double typical = Median(half_widths, 0);
  double widest = typical;
  for (const double half : half_widths)
    if (half <= 3 * typical) widest = std::max(widest, half);
  return PaddedRange(low - widest, high + widest, 0);
}

void AddLevels(SvgPlot& plot, const ReportInput& input, const ParameterAnalysis& analysis,
               const ParameterInfo& info, bool with_labels) {
  const auto add = [&](const std::optional<double>& level, LineStyle style, const std::string& label) {
    if (level)
      plot.Level(info.Shown(*level), style, with_labels ? label + " " + FormatShort(info.Shown(*level)) : "");
  };
  for (const MonitorSpec& monitor : input.machine.monitors) {
    if (monitor.parameter != analysis.parameter) continue;
    add(monitor.reference, {Ink::kNeutral, Dash::kDotted, 1.3}, "reference");
    for (const auto& level : {monitor.warn_low, monitor.warn_high})
      add(level, {Ink::kOrange, Dash::kDashed, 1.4}, "warning");
    for (const auto& level : {monitor.alarm_low, monitor.alarm_high})
      add(level, {Ink::kVermillion, Dash::kDashDot, 1.6}, "alarm");
  }
}

std::string PointTitle(const TrendSample& sample, const ParameterInfo& info, const CountedWords& counted) {
  std::string title = fmt::format(
      "{} {}: {} {}", counted.one, FormatCount(sample.sequence),
      FormatWithUncertainty(info.Shown(sample.value), kNormal95 * sample.std * info.factor), info.unit);
  if (std::isfinite(sample.temperature))
    title += fmt::format(", oil {} °C", FormatFixed(sample.temperature - kZeroCelsius, 1));
  if (!sample.updated) title += std::string(", not updated: ") + ReasonText(sample.reason);
  return title;
}

/// Plot columns of the samples that were updated, or of those that were not.
struct Columns {
  std::vector<double> x, y, low, high;
  std::vector<std::string> titles;
};
template <typename XOf>
Columns ColumnsOf(const std::vector<TrendSample>& samples, const ParameterInfo& info,
                  const CountedWords& counted, bool updated, XOf x_of) {
  Columns columns;
  for (const TrendSample& sample : samples) {
    if (sample.updated != updated || !std::isfinite(x_of(sample))) continue;
    const double half = std::isfinite(sample.std) ? kNormal95 * sample.std : 0;
    columns.x.push_back(x_of(sample));
    columns.y.push_back(info.Shown(sample.value));
    columns.low.push_back(info.Shown(sample.value - half));
    columns.high.push_back(info.Shown(sample.value + half));
    columns.titles.push_back(PointTitle(sample, info, counted));
  }
  return columns;
}

std::vector<double> RunBorders(const ReportInput& input) {
  std::vector<double> borders;
  if (input.runs.size() < 2 || input.runs.size() > 60) return borders;
  for (const RunInfo& run : input.runs) borders.push_back(static_cast<double>(run.first_sequence) - 0.5);
  return borders;
}

std::string NumberOf(const CountedWords& counted) { return fmt::format("{} number", counted.one); }

std::vector<double> StrokeNumbers(const ReportInput& input) {
  std::vector<double> numbers;
  for (const StrokeSummary& stroke : input.strokes) numbers.push_back(static_cast<double>(stroke.index));
  return numbers;
}

}  // namespace

std::string TrendPlot(const ReportInput& input, const ParameterAnalysis& analysis,
                      const ParameterInfo& info) {
  SvgPlot::Options options;
  const CountedWords counted = CountedWordsOf(input.machine);
  options.x_label = NumberOf(counted);
  options.title = AxisLabel(info) + " over " + options.x_label;
  options.y_label = AxisLabel(info);
  options.whole_x = true;
  if (!analysis.samples.empty()) options.y_range = ValueRange(analysis.samples, info);
  SvgPlot plot(options);
  const auto number = [](const TrendSample& sample) { return static_cast<double>(sample.sequence); };
  Columns updated = ColumnsOf(analysis.samples, info, counted, true, number);
  Columns stale = ColumnsOf(analysis.samples, info, counted, false, number);
  plot.Borders(RunBorders(input));
  plot.Band(updated.x, updated.low, updated.high, Ink::kBlue, updated.x.size() < 2 ? "" : "95 % interval");
  if (updated.x.size() == 1) plot.ErrorBars(updated.x, updated.low, updated.high, Ink::kBlue);
  AddLevels(plot, input, analysis, info, true);
  plot.Line(updated.x, updated.y, {Ink::kBlue, Dash::kSolid, 1.2}, "");
  if (updated.x.size() <= 600)
    plot.Points(updated.x, updated.y,
                {Ink::kBlue, Marker::kCircle, updated.x.size() > 150 ? 1.4 : 2.4, false}, "", updated.titles);
  plot.Points(stale.x, stale.y, {Ink::kNeutral, Marker::kCross, 2.4, true},
              stale.x.empty() ? "" : "not updated", stale.titles);
  return plot.Render();
}

std::string OilPlot(const ReportInput& input, const ParameterAnalysis& analysis, const ParameterInfo& info) {
  const OilDependence& oil = analysis.oil;
  if (oil.outcome == OilOutcome::kNone || oil.outcome == OilOutcome::kNotMeasured ||
      oil.outcome == OilOutcome::kTooFewStrokes)
    return "";
  SvgPlot::Options options;
  options.width = 350;
  options.title = AxisLabel(info) + " over oil temperature";
  options.x_label = "oil temperature (°C)";
  options.y_label = info.symbol + (info.unit.empty() ? "" : " (" + info.unit + ")");
  options.y_range = ValueRange(analysis.blocks, info);
  SvgPlot plot(options);
  Columns points = ColumnsOf(analysis.blocks, info, CountedWordsOf(input.machine), true,
                             [](const TrendSample& s) { return s.temperature - kZeroCelsius; });
  AddLevels(plot, input, analysis, info, false);
  plot.ErrorBars(points.x, points.low, points.high, Ink::kBlue);
  plot.Points(points.x, points.y, {Ink::kBlue, Marker::kCircle, 2.4, false}, "", points.titles);
  if (oil.line.coefficients.empty()) return plot.Render();
  std::vector<double> x, line, low, high;
  const double quantile = StudentHalfWidth95(oil.line.coefficients[1].degrees);
  for (int k = 0; k <= 24; ++k) {
    const double temperature = oil.coldest + k * (oil.warmest - oil.coldest) / 24;
    const double value = oil.value_at_mean + oil.slope.value * (temperature - oil.mean_temperature);
    const double half = quantile * oil.line.StdAt({1, temperature - oil.mean_temperature});
    x.push_back(temperature - kZeroCelsius);
    line.push_back(info.Shown(value));
    low.push_back(info.Shown(value - half));
    high.push_back(info.Shown(value + half));
  }
  plot.Band(x, low, high, Ink::kVermillion, "");
  plot.Line(x, line, {Ink::kVermillion, Dash::kDashed, 2}, "line, 95 %");
  return plot.Render();
}

std::string OverlayPlot(const StrokeOverlay& overlay, const CountedWords& counted) {
  const std::size_t n = std::min({overlay.time.size(), overlay.measured.size(), overlay.modelled.size()});
  const bool extended = overlay.extended.size() >= n && n > 0;
  std::vector<double> time, measured, modelled, residual, better, rest;
  for (std::size_t i = 0; i < n; ++i) {
    time.push_back(overlay.time[i] - overlay.time[0]);
    measured.push_back(overlay.measured[i] * overlay.unit.factor);
    modelled.push_back(overlay.modelled[i] * overlay.unit.factor);
    residual.push_back(measured[i] - modelled[i]);
    if (!extended) continue;
    better.push_back(overlay.extended[i] * overlay.unit.factor);
    rest.push_back(measured[i] - better[i]);
  }
  const AxisRange span = PaddedRange(0, time.empty() ? 1 : time.back(), 0.01);
  SvgPlot::Options options;
  options.width = kPageWidth;
  options.height = 250;
  options.title =
      fmt::format("{} of {} {}, measured and modelled", overlay.output, counted.one, overlay.sequence);
  options.y_label = fmt::format("{} ({})", overlay.output, overlay.unit.name);
  options.x_range = span;
  options.x_tick_labels = false;
  SvgPlot flow(options);
  flow.Line(time, measured, {Ink::kBlue, Dash::kSolid, 2.4}, "measured");
  flow.Line(time, modelled, {Ink::kVermillion, Dash::kDashed, 1.7}, extended ? "model as it is" : "model");
  if (extended) flow.Line(time, better, {Ink::kGreen, Dash::kDotted, 1.7}, "extended");

  options.height = 165;
  options.title =
      fmt::format("{} of {} {}, measured minus modelled", overlay.output, counted.one, overlay.sequence);
  options.y_label = fmt::format("measured − model ({})", overlay.unit.name);
  options.x_label = fmt::format("time in the {} (s)", counted.one);
  options.x_tick_labels = true;
  SvgPlot error(options);
  if (overlay.noise_floor > 0) {
    const double half = kNormal95 * overlay.noise_floor * overlay.unit.factor;
    error.Band({span.low, span.high}, {-half, -half}, {half, half}, Ink::kNeutral, "95 % of sensor noise");
  }
  error.Level(0, {Ink::kNeutral, Dash::kSolid, 1}, "");
  error.Line(time, residual, {extended ? Ink::kVermillion : Ink::kGreen, Dash::kSolid, 1.4},
             extended ? "measured − model as it is" : "measured − model");
  if (extended) error.Line(time, rest, {Ink::kGreen, Dash::kSolid, 1.4}, "measured − extended");
  return flow.Render() + error.Render();
}

std::string ErrorPlot(const ReportInput& input) {
  SvgPlot::Options options;
  options.width = kPageWidth;
  options.height = 215;
  const CountedWords counted = CountedWordsOf(input.machine);
  options.title = fmt::format("model error of every {}", counted.one);
  options.x_label = NumberOf(counted);
  const DisplayUnit unit = UnitOfErrors(input.machine);
  options.y_label = fmt::format("{} error, rms ({})", WordsOf(input.machine).output.english, unit.name);
  options.whole_x = true;
  std::vector<double> error, floor;
  std::vector<std::string> titles;
  double most = 0;
  for (const StrokeSummary& stroke : input.strokes) {
    error.push_back(stroke.rms_error * unit.factor);
    floor.push_back(stroke.noise_floor > 0 ? stroke.noise_floor * unit.factor : std::nan(""));
    most = std::fmax(most, std::fmax(error.back(), floor.back()));
    titles.push_back(fmt::format("{} {}: error {} {}, noise floor {} {}", counted.one,
                                 FormatCount(stroke.index), FormatShort(error.back()), unit.name,
                                 FormatShort(floor.back()), unit.name));
  }
  if (most > 0) options.y_range = AxisRange{0, most};
  SvgPlot plot(options);
  const std::vector<double> x = StrokeNumbers(input);
  plot.Borders(RunBorders(input));
  plot.Line(x, floor, {Ink::kNeutral, Dash::kDashed, 1.6}, "noise floor: sensor noise alone");
  plot.Line(x, error, {Ink::kBlue, Dash::kSolid, 0.9}, "");
  plot.Points(x, error, {Ink::kBlue, Marker::kDiamond, x.size() > 150 ? 1.6 : 2.4, false}, "model error",
              titles);
  return plot.Render();
}

std::string TemperaturePlot(const ReportInput& input) {
  SvgPlot::Options options;
  options.width = kPageWidth;
  options.height = 150;
  const CountedWords counted = CountedWordsOf(input.machine);
  options.title = fmt::format("oil temperature of every {}", counted.one);
  options.x_label = NumberOf(counted);
  options.y_label = "oil temperature (°C)";
  options.whole_x = true;
  SvgPlot plot(options);
  std::vector<double> temperature;
  bool any = false;
  for (const StrokeSummary& stroke : input.strokes) {
    temperature.push_back(stroke.oil_temperature - kZeroCelsius);
    any |= std::isfinite(stroke.oil_temperature);
  }
  if (!any) return "";
  plot.Borders(RunBorders(input));
  if (temperature.size() < 3)
    plot.Points(StrokeNumbers(input), temperature, {Ink::kOrange, Marker::kSquare, 3, false}, "");
  plot.Line(StrokeNumbers(input), temperature, {Ink::kOrange, Dash::kSolid, 1.8}, "");
  return plot.Render();
}

}  // namespace hydroscope
