#include "report/drift_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/constants.h"
#include "monitor/mean_deviation.h"
#include "report/report_page.h"
#include "report/report_parameters.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "workbench/history/stored_change.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kMostStrokesShown = 6000;  ///< judged strokes shown, the newest
constexpr std::size_t kMostBlocks = 150;
constexpr int kCurvePoints = 60;
constexpr double kNarrow = 350;  ///< px

/// Means of consecutive judged strokes, weighted by their information.
struct Blocks {
  std::vector<double> stroke, temperature, deviation, reference, std;
};

Blocks BlocksOf(const std::vector<AxisMonitor::JudgedValue>& values, int quantity) {
  Blocks blocks;
  const std::size_t size = (values.size() + kMostBlocks - 1) / kMostBlocks;
  for (std::size_t from = 0; from < values.size(); from += size) {
    const MeanDeviation mean =
        MeanDeviationOf(std::span(values).subspan(from, std::min(size, values.size() - from)), quantity);
    if (mean.strokes == 0) continue;
    blocks.stroke.push_back(mean.stroke);
    blocks.temperature.push_back(mean.oil_temperature - kZeroCelsius);
    blocks.deviation.push_back(mean.value);
    blocks.reference.push_back(mean.reference);
    blocks.std.push_back(mean.std);
  }
  return blocks;
}

/// The curve as learned, its points, and what was judged since.
std::string CurvePlot(const drift::TemperatureModel& curve, const Blocks& blocks, const ParameterInfo& info) {
  SvgPlot::Options options;
  options.title = AxisLabel(info) + " over oil temperature";
  options.x_label = "oil temperature (°C)";
  options.y_label = AxisLabel(info);
  options.width = kNarrow;
  SvgPlot plot(options);
  double low = curve.low() - kZeroCelsius, high = curve.high() - kZeroCelsius;
  for (const double t : blocks.temperature) {
    low = std::min(low, t);
    high = std::max(high, t);
  }
  std::vector<double> x, value, below, above;
  for (int k = 0; k <= kCurvePoints; ++k) {
    x.push_back(low + (high - low) * k / kCurvePoints);
    const auto p = curve.At(x.back() + kZeroCelsius);
    value.push_back(info.Shown(p.value));
    below.push_back(info.Shown(p.value - kNormal95 * p.std));
    above.push_back(info.Shown(p.value + kNormal95 * p.std));
  }
  plot.Band(x, below, above, Ink::kGreen, "95 % of the curve");
  plot.Line(x, value, {Ink::kGreen, Dash::kSolid, 1.8}, "healthy: " + curve.FormName());
  std::vector<double> learned_x, learned_y, judged;
  for (const drift::TemperaturePoint& p : curve.points()) {
    learned_x.push_back(p.temperature - kZeroCelsius);
    learned_y.push_back(info.Shown(p.value));
  }
  plot.Points(learned_x, learned_y, {Ink::kGreen, Marker::kDiamond, 3.2, true}, "learned from");
  for (std::size_t k = 0; k < blocks.stroke.size(); ++k)
    judged.push_back(info.Shown(blocks.reference[k] + blocks.deviation[k]));
  plot.Points(blocks.temperature, judged, {Ink::kBlue, Marker::kCircle, 2.6}, "judged");
  return "<figure>" + plot.Render() + "</figure>";
}

std::string DeviationPlot(const Blocks& blocks, const ParameterInfo& info, double tolerated,
                          std::vector<double> changes, double width, const CountedWords& counted) {
  const double factor = std::abs(info.factor);
  SvgPlot::Options options;
  options.title = fmt::format("Deviation of {} over {}", AxisLabel(info), counted.many);
  options.x_label = counted.one;
  options.y_label = info.symbol + ", deviation" + (info.unit.empty() ? "" : " (" + info.unit + ")");
  options.whole_x = true;
  options.width = width;
  SvgPlot plot(options);
  std::vector<double> low, high, middle;
  for (std::size_t k = 0; k < blocks.stroke.size(); ++k) {
    middle.push_back(factor * blocks.deviation[k]);
    low.push_back(factor * (blocks.deviation[k] - kNormal95 * blocks.std[k]));
    high.push_back(factor * (blocks.deviation[k] + kNormal95 * blocks.std[k]));
  }
  plot.Borders(std::move(changes));
  plot.ErrorBars(blocks.stroke, low, high, Ink::kBlue);
  plot.Points(blocks.stroke, middle, {Ink::kBlue, Marker::kCircle, 2.6}, "");
  plot.Level(0, {Ink::kGreen, Dash::kSolid, 1.4}, "healthy");
  plot.Level(factor * tolerated, {Ink::kNeutral, Dash::kDotted, 1.2}, "worth finding");
  plot.Level(-factor * tolerated, {Ink::kNeutral, Dash::kDotted, 1.2}, "");
  return "<figure>" + plot.Render() + "</figure>";
}

std::string LearnedFrom(const drift::Reference& reference, std::size_t judged, const CountedWords& counted) {
  return fmt::format(
      "<p class=\"note\">Reference {}, learned from {strokes} {} to {}: {} kinds of {stroke}. Left: deviation of "
      "the {} {strokes} judged since, in blocks, with 95 % intervals; uprights: where a change began. Right: the "
      "healthy value over oil temperature as learned (diamonds: {strokes} of nearly the same temperature together) "
      "and what was judged. Each quantity stands alone here: one real change shows in several of them, and which "
      "is the cause is decided by all together.</p>\n",
      reference.version(), reference.first_sequence(), reference.last_sequence(), reference.classes().count(),
      judged, fmt::arg("stroke", counted.one), fmt::arg("strokes", counted.many));
}

/// Strokes at which changes of a quantity began.
std::vector<double> ChangesOf(const drift::DriftMonitor& monitor, const std::string& quantity) {
  std::vector<double> changes;
  for (const drift::DriftFinding& finding : monitor.findings())
    for (const drift::FindingPart& part : finding.parts)
      if (part.quantity == quantity) changes.push_back(static_cast<double>(finding.since.last_before + 1));
  return changes;
}

/// One quantity; "" if it is not watched or nothing of it was judged.
std::string QuantityPlots(const drift::DriftMonitor& monitor, int q,
                          const std::vector<AxisMonitor::JudgedValue>& values) {
  const drift::Quantity& quantity = monitor.model().quantities()[q];
  const Blocks blocks = BlocksOf(values, q);
  if (!monitor.watched(q) || blocks.stroke.empty()) return "";
  const double typical = monitor.reference().typical(q);
  const ParameterInfo info = InfoForQuantity(monitor.model().kind(), quantity, typical);
  const CountedWords counted = CountedWordsOf(monitor.model().kind());
  const double width = quantity.effect ? kPageWidth : SvgPlot::Options().width;
  const std::string deviation = DeviationPlot(blocks, info, monitor.sizes(q).smallest,
                                              ChangesOf(monitor, quantity.name), width, counted);
  if (quantity.effect) return deviation;
  return "<div class=\"pair\">" + deviation + CurvePlot(monitor.reference().curves()[q], blocks, info) +
         "</div>\n";
}

/// Finding, evidence, cause and action apart, as far as the alarm has them apart.
std::string InWords(const AlarmState& alarm, const CountedWords& counted) {
  const bool apart = !alarm.words.finding.empty() && !alarm.words.evidence.empty();
  const std::string id = EscapeText(alarm.id);
  std::string out = fmt::format(
      "<li>{}, {}{}{}: ",
      apart ? "<b>" + EscapeText(alarm.words.finding.english) + "</b> (" + id + ")" : "<b>" + id + "</b>",
      SeverityName(alarm.severity),
      alarm.raised_stroke > 0 ? fmt::format(", raised at {} {}", counted.one, alarm.raised_stroke) : "",
      alarm.acknowledged ? ", acknowledged" : "");
  if (!apart) return out + EscapeText(alarm.text) + "</li>";
  out += EscapeText(alarm.words.evidence.english);
  if (const std::string cause = CauseText(alarm.cause); !cause.empty())
    out += "<br><b>Cause:</b> " + EscapeText(cause);
  if (!alarm.words.action.empty()) out += "<br><b>What to do:</b> " + EscapeText(alarm.words.action.english);
  return out + "</li>";
}

}  // namespace

std::string NotStoredBox(const std::string& why) {
  if (why.empty()) return "";
  return fmt::format(
      "<section class=\"verdict alarmed\"><h2>■ This is old: nothing is stored now, alarms neither</h2><ul><li>{}</li><li>What "
      "follows holds up to the last stroke shown; what happened since, it does not know.</li></ul></section>\n",
      EscapeText(why));
}

std::string AlarmsBox(const std::vector<AlarmState>& press, const std::vector<AlarmState>& axis,
                      const CountedWords& counted) {
  std::string sentences;
  bool changed = false;
  AlarmSeverity worst = AlarmSeverity::kAdvisory;
  for (const auto* alarms : {&press, &axis})
    for (const AlarmState& alarm : *alarms) {
      if (!alarm.active || alarm.suppressed != 0 || alarm.out_of_service) continue;
      worst = std::max(worst, alarm.severity);
      changed = changed || TellsAChange(alarm);
      sentences += InWords(alarm, counted);
    }
  if (sentences.empty()) return "";
  const bool alarmed = worst >= AlarmSeverity::kAlarm;
  return fmt::format("<section class=\"verdict {}\"><h2>{} {}</h2><ul>{}</ul></section>\n",
                     alarmed ? "alarmed" : "warned", alarmed ? "■" : "▲",
                     changed ? "The machine has changed since it was learned" : "Alarms stand", sentences);
}

Result<std::string> DriftSection(const AxisMonitor& axis, int commissioning) {
  std::string out = "<h2>Drift against the healthy machine</h2>\n";
  if (axis.monitor() == nullptr)
    return out +
           fmt::format("<p>Nothing is judged yet: the healthy machine is being learned, {} of {} {}.</p>\n",
                       axis.commissioning_strokes(), commissioning, axis.counted().many);
  const drift::DriftMonitor& monitor = *axis.monitor();
  const drift::Reference& reference = monitor.reference();
  const std::int64_t first = std::max(reference.last_sequence() + 1, axis.next_stroke() - kMostStrokesShown);
  const auto values = TRY(axis.JudgedValues(first, axis.next_stroke() - first));
  out += LearnedFrom(reference, values.size(), CountedWordsOf(monitor.model().kind()));
  std::string moved, quiet;  // what has changed comes first
  for (int q = 0; q < monitor.model().size(); ++q) {
    const std::string& name = monitor.model().quantities()[q].name;
    (ChangesOf(monitor, name).empty() ? quiet : moved) += QuantityPlots(monitor, q, values);
  }
  return out + moved + quiet;
}

}  // namespace hydroscope
