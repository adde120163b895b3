#include "report/report.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "core/constants.h"
#include "core/time_text.h"
#include "host/text_sink.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "report/error_words.h"
#include "report/report_page.h"
#include "report/report_plots.h"
#include "report/report_words.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

const char* ClassOf(Standing standing) {
  switch (standing) {
    case Standing::kSteady:
      return "steady";
    case Standing::kOil:
      return "oil";
    case Standing::kUnknown:
      return "unknown";
    case Standing::kHint:
      return "hint";
    case Standing::kChanged:
      return "changed";
    case Standing::kWarned:
      return "warned";
    case Standing::kAlarmed:
      return "alarmed";
  }
  return "unknown";
}

/// A shape beside the colour.
const char* ShapeOf(Standing standing) {
  switch (standing) {
    case Standing::kSteady:
      return "✓";
    case Standing::kOil:
      return "≈";
    case Standing::kUnknown:
      return "?";
    case Standing::kHint:
      return "△";
    case Standing::kChanged:
      return "◆";
    case Standing::kWarned:
      return "▲";
    case Standing::kAlarmed:
      return "■";
  }
  return "?";
}

/// Everything worked out once, for all sections.
struct Report {
  const ReportInput& input;
  TrendAnalysis analysis;
  std::vector<ParameterInfo> infos;
  std::vector<ParameterWords> words;
  ReportVerdict verdict;
  CountedWords counted;
  bool has_oil = true;
};

/// Of a machine that drives no oil, or is judged without its temperature, nothing is said about it.
bool HasOil(const Machine& machine, const TrendAnalysis& analysis) {
  const MachineKind& kind = KindOf(machine);
  return std::isfinite(analysis.coldest) ||
         (!kind.temperature.empty() && (!kind.own_library || machine.SignalIndex(kind.temperature) >= 0));
}

/// The interval of the newest estimate as it is stated; changes are judged without what all strokes share.
void StateAsStored(const ReportInput& input, ParameterAnalysis& analysis) {
  const auto known = std::ranges::find(input.latest, analysis.parameter, &Estimate::parameter);
  if (known != input.latest.end() && !analysis.samples.empty())
    StateLatest(known->std / analysis.samples.back().std, input.machine, analysis);
}

Report Prepare(const ReportInput& input) {
  Report report{input, AnalyseTrends(input), {}, {}, {}, CountedWordsOf(input.machine)};
  report.has_oil = HasOil(input.machine, report.analysis);
  for (ParameterAnalysis& analysis : report.analysis.parameters) {
    if (!report.has_oil) analysis.oil.outcome = OilOutcome::kNone;
    StateAsStored(input, analysis);
    const double typical = analysis.samples.empty() ? 0 : analysis.samples.back().value;
    report.infos.push_back(InfoFor(KindOf(input.machine), analysis.parameter, analysis.unit, typical));
    report.words.push_back(DescribeParameter(analysis, report.infos.back(), report.counted, input.alarms));
    if (const Confounding* c = FindConfounding(input.confounded, analysis.parameter))
      report.words.back().confounded = EscapeText(c->reason.english + "; " + c->advice.english);
  }
  report.verdict = DescribeVerdict(input, report.analysis, report.infos, report.words);
  return report;
}

std::string SourcesText(const std::vector<RunInfo>& runs) {
  if (runs.empty()) return "no log";
  if (runs.size() == 1) return EscapeText(runs.front().source);
  return fmt::format("{} logs, {} … {}", FormatCount(static_cast<std::int64_t>(runs.size())),
                     EscapeText(runs.front().source), EscapeText(runs.back().source));
}

std::string Header(const Report& report) {
  const ReportInput& input = report.input;
  std::string out = fmt::format("<header><div><h1>Maintenance report: {}</h1><p class=\"soft\">",
                                EscapeText(input.machine.name));
  out += SourcesText(input.runs) + fmt::format(" · model version {}", input.machine.model_version);
  if (!input.created.empty()) out += " · " + EscapeText(input.created);
  out += "</p>";
  if (!input.machine.description.empty())
    out += "<p class=\"soft\">" + EscapeText(input.machine.description) + "</p>";
  return out + "</div></header>\n";
}

std::string VerdictBox(const Report& report) {
  const ReportVerdict& verdict = report.verdict;
  std::string out = fmt::format("<section class=\"verdict {}\"><h2>{} {}</h2><ul>", ClassOf(verdict.standing),
                                ShapeOf(verdict.standing), verdict.headline);
  for (const std::string& sentence : verdict.sentences) out += "<li>" + sentence + "</li>";
  return out + "</ul></section>\n";
}

std::string Term(const std::string& name, const std::string& text) {
  return text.empty() ? "" : "<dt>" + name + "</dt><dd>" + text + "</dd>";
}

std::string Card(const ParameterAnalysis& analysis, const ParameterInfo& info, const ParameterWords& words,
                 const CountedWords& counted) {
  std::string out = fmt::format(
      "<article class=\"card {}\"><h3><span>{}</span> <span "
      "class=\"name\">{}</span><span class=\"pill\">{} {}</span></h3>",
      ClassOf(words.standing), HtmlSymbol(info.symbol), EscapeText(info.name), ShapeOf(words.standing),
      words.pill);
  const std::string note = analysis.latest ? fmt::format(" <span>95 % interval, {} {}</span>", counted.one,
                                                         FormatCount(analysis.latest->sequence))
                                           : "";
  out +=
      "<p class=\"value\">" + words.value + note + "</p><p class=\"reading\">" + words.reading + "</p><dl>";
  out += Term("Not identifiable", words.confounded) + Term("Over the record", words.change) +
         Term("Oil temperature", words.oil) + Term("Limits", words.limits);
  return out + "</dl></article>\n";
}

std::string Cards(const Report& report) {
  std::string out = "<div class=\"cards\">\n";
  for (std::size_t i = 0; i < report.infos.size(); ++i)
    out += Card(report.analysis.parameters[i], report.infos[i], report.words[i], report.counted);
  return out +
         fmt::format(
             "</div>\n<p class=\"note\">Over the record: mean of the last third of the {} minus that of the "
             "first, ± half of its 95 % interval. "
             "p: how often chance alone would show as much anywhere among these numbers; below 0.01 is called "
             "clear, below 0.05 a hint.</p>\n",
             report.counted.many);
}

std::string Tile(const std::string& value, const std::string& label) {
  return "<div class=\"tile\"><b>" + value + "</b><span>" + label + "</span></div>";
}

/// When the strokes were made, or where the logs know no date how long they last together.
std::string TimeTile(const ReportInput& input, double duration, const CountedWords& counted) {
  if (!input.strokes.empty() && CountsFrom1970(input.strokes.front().begin)) {
    const double first = input.strokes.front().begin, last = input.strokes.back().end;
    return Tile(DurationText(last - first),
                fmt::format("from {} to {}, first to last {}", LocalTimeText(first), LocalTimeText(last),
                            counted.one));
  }
  const std::string of =
      input.runs.size() > 1 ? fmt::format(", added up over {} logs without dates", input.runs.size()) : "";
  return Tile(DurationText(duration), fmt::format("from first to last {}{}", counted.one, of));
}

std::string Tiles(const Report& report) {
  const TrendAnalysis& analysis = report.analysis;
  const ModelErrors errors = OverallErrors(report.input, analysis);
  std::string oil = "–", error = "–";
  if (std::isfinite(analysis.coldest))
    oil = FormatFixed(analysis.coldest - kZeroCelsius, 1) + " … " +
          FormatFixed(analysis.warmest - kZeroCelsius, 1) + " °C";
  const DisplayUnit unit = UnitOfErrors(report.input.machine);
  const auto shown = [&](double si) { return FormatShort(si * unit.factor) + " " + std::string(unit.name); };
  if (errors.rms > 0) error = shown(errors.rms);
  std::string out = "<div class=\"tiles\">";
  out += Tile(FormatCount(static_cast<std::int64_t>(report.input.strokes.size())),
              std::string(report.counted.many));
  out += Tile(FormatCount(report.input.rows), "rows read");
  out += TimeTile(report.input, analysis.duration, report.counted);
  if (report.has_oil) out += Tile(oil, "oil temperature");
  out += Tile(error, errors.floor > 0 ? "model error, rms; sensor noise alone: " + shown(errors.floor)
                                      : "model error, rms");
  return out + "</div>\n";
}

/// "Stroke 12, the one of largest error."
std::string OverlayFigure(const StrokeOverlay& overlay, const CountedWords& counted) {
  return Figure(
      OverlayPlot(overlay, counted),
      fmt::format("{} {}{}. Below: what the model leaves unexplained; the grey band holds 95 % of what "
                  "sensor noise alone would leave. Swings beyond the band are model error.",
                  counted.capital, FormatCount(overlay.sequence),
                  overlay.label.empty() ? "" : ", the one of " + EscapeText(overlay.label)));
}

std::string TrendsNote(const Report& report, bool with_oil) {
  std::string out = "<p class=\"note\">";
  out += fmt::format("{} {}'s estimate with its 95 % interval", with_oil ? "Left: every" : "Every",
                     report.counted.one);
  out += report.input.runs.size() > 1 && report.input.runs.size() <= 60
             ? "; dotted uprights: a new log begins."
             : ".";
  if (with_oil)
    out += fmt::format(
        " Right: blocks of consecutive {}, each fitted by itself, over their mean oil temperature, with "
        "the straight line through them and its 95 % interval.",
        report.counted.many);
  return out + "</p>\n";
}

/// What the card says of the same values.
std::string PlotCaption(const ParameterWords& words) {
  return words.change.empty() ? "" : "Over the record: " + words.change + ".";
}

/// With oil temperatures a pair of plots per parameter, else the trends in two columns.
std::string Trends(const Report& report) {
  std::string pairs, trends;
  for (std::size_t i = 0; i < report.infos.size(); ++i) {
    const ParameterAnalysis& analysis = report.analysis.parameters[i];
    if (analysis.samples.empty()) continue;
    const std::string trend =
        Figure(TrendPlot(report.input, analysis, report.infos[i]), PlotCaption(report.words[i]));
    const std::string oil = OilPlot(report.input, analysis, report.infos[i]);
    if (oil.empty())
      trends += trend;
    else
      pairs += "<div class=\"pair\">" + trend + Figure(oil, "") + "</div>\n";
  }
  std::string out = fmt::format("<h2>Parameters over {}{}</h2>", report.counted.many,
                                pairs.empty() ? "" : " and over oil temperature");
  if (pairs.empty() && trends.empty())
    return out + "<p>No parameter was identified, so there is nothing to draw.</p>\n";
  out += TrendsNote(report, !pairs.empty()) + pairs;
  if (!trends.empty()) out += "<div class=\"trends\">" + trends + "</div>\n";
  const std::string temperature = TemperaturePlot(report.input);
  return temperature.empty() ? out : out + Figure(temperature, "");
}

std::string ModelAgainstMeasurement(const Report& report) {
  std::string out = "<h2>Model against measurement</h2>\n";
  for (const StrokeOverlay& overlay : report.input.overlays) out += OverlayFigure(overlay, report.counted);
  if (!report.input.strokes.empty())
    out += Figure(ErrorPlot(report.input),
                  fmt::format("Error of each {0}, predicted with the model as it stood before that {0}. The "
                              "distance from the dashed line is what the model does not know.",
                              report.counted.one));
  if (report.input.strokes.empty() && report.input.overlays.empty())
    out += fmt::format("<p>No {} to compare.</p>\n", report.counted.one);
  return out;
}

std::string FlagText(std::string_view name) {
  std::string text(name);
  for (char& c : text)
    if (c == '_') c = ' ';
  return text;
}

/// Rows of the strokes by what became of them, and rows per quality flag.
std::string QualityTable(const ReportInput& input, const CountedWords& counted) {
  StrokeCounters sum;
  for (const StrokeSummary& stroke : input.strokes) {
    sum.samples += stroke.counters.samples;
    sum.gated += stroke.counters.gated;
    sum.used += stroke.counters.used;
    for (std::size_t k = 0; k < sum.flagged.size(); ++k) sum.flagged[k] += stroke.counters.flagged[k];
  }
  std::string out = fmt::format(
      "<div class=\"sheet\"><table><tr><th>Rows within {}</th><th class=\"number\">Rows</th><th "
      "class=\"number\">Share</th></tr>",
      counted.many);
  const auto row = [&](const std::string& what, std::int64_t rows) {
    const double share =
        sum.samples > 0 ? 100.0 * static_cast<double>(rows) / static_cast<double>(sum.samples) : 0;
    out += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{} %</td></tr>", what,
                       FormatCount(rows), FormatFixed(share, 1));
  };
  row("seen", sum.samples);
  row("in the phase the model describes", sum.gated);
  row("used for the parameters", sum.used);
  bool flagged = false;
  for (const quality::FlagName& flag : quality::kFlagNames) {
    const auto rows = sum.flagged[std::countr_zero(flag.flag)];
    if (rows > 0) row("flagged " + FlagText(flag.name), rows), flagged = true;
  }
  out += "</table>";
  if (!flagged) out += fmt::format("<p class=\"note\">No value within the {} was flagged.</p>", counted.many);
  return out + "</div>\n";
}

std::string Skipped(const Report& report) {
  std::string out = "<h2>What was skipped, and the quality of the data</h2>\n";
  if (report.input.skipped.empty()) {
    out += "<p>Nothing was skipped.</p>\n";
  } else {
    out += "<div class=\"sheet\"><table><tr><th>Left out</th><th class=\"number\">Rows</th><th>Why</th></tr>";
    for (const SkippedItem& item : report.input.skipped)
      out += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td><td>{}</td></tr>", EscapeText(item.what),
                         FormatCount(item.rows), EscapeText(item.why));
    out += "</table></div>\n";
  }
  if (!report.input.strokes.empty()) out += QualityTable(report.input, report.counted);
  std::string rows;
  for (std::size_t i = 0; i < report.infos.size(); ++i)
    for (const auto& [reason, count] : report.analysis.parameters[i].not_updated)
      rows += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td><td>{}</td></tr>",
                          HtmlSymbol(report.infos[i].symbol), FormatCount(static_cast<std::int64_t>(count)),
                          ReasonText(reason));
  if (!rows.empty())
    out += fmt::format(
        "<div class=\"sheet\"><table><tr><th>Parameter not updated</th><th "
        "class=\"number\">{}s</th><th>Why</th></tr>{}</table></div>\n",
        report.counted.capital, rows);
  return out;
}

std::string MethodText(const Machine& machine) {
  const EstimatorSpec& estimator = machine.estimator;
  if (InEpisodes(KindOf(machine)))
    return fmt::format(
        "each episode linearised in its parameters; directional forgetting "
        "with {} s of excited data, over five episodes at least",
        FormatShort(estimator.time_constant));
  std::string out = estimator.equation == EquationForm::kPublished
                        ? "recursive least squares on filtered derivatives, as published"
                        : "recursive least squares on the balance integrated over blocks";
  if (estimator.equation == EquationForm::kIntegral)
    out += fmt::format("; blocks of {} ms in spans of {} s", FormatShort(machine.window.block * 1e3),
                       FormatShort(machine.window.span));
  if (estimator.equation == EquationForm::kIntegral && estimator.form == EstimatorForm::kDirectional)
    return out + fmt::format("; directional forgetting with {} s of excited data",
                             FormatShort(estimator.time_constant));
  return out + fmt::format("; exponential forgetting with λ = {} per update",
                           FormatShort(estimator.forgetting_factor));
}

std::string Method(const Report& report) {
  const Machine& machine = report.input.machine;
  std::string effects;
  for (const std::string& effect : machine.added_effects)
    effects += (effects.empty() ? "" : ", ") + EscapeText(effect);
  std::string out = "<h2>How this was computed</h2><div class=\"sheet\"><dl class=\"terms\">";
  out += Term("Model", fmt::format("{}, version {}; added effects: {}", EscapeText(machine.model),
                                   machine.model_version, effects.empty() ? "none" : effects));
  out += Term("Estimator", MethodText(machine));
  out += Term(
      "Intervals",
      fmt::format(
          "95 %. Estimates carry their estimator's standard error. Successive estimates share most of their {0}, "
          "so changes{1} are judged on blocks of consecutive {0} that share none, each fitted by itself.",
          report.counted.many, report.has_oil ? " and slopes over oil temperature" : ""));
  out += Term("Noise floor",
              "The error that sensor noise alone would cause, sent through the same "
              "filters. Error above it is model error.");
  if (!report.input.program_version.empty())
    out += Term("Program", "hydroscope " + EscapeText(report.input.program_version));
  out += "</dl></div>\n<h2>Parameters in one sentence</h2><div class=\"sheet\"><dl class=\"terms\">";
  for (const ParameterInfo& info : report.infos) {
    const auto note = report.input.parameter_notes.find(info.id);
    const std::string sentence = !info.sentence.empty() ? info.sentence
                                 : note != report.input.parameter_notes.end()
                                     ? EscapeText(note->second)
                                     : "A parameter of the machine file or of an added effect.";
    out += Term(HtmlSymbol(info.symbol) + (info.name.empty() ? "" : ", " + EscapeText(info.name)), sentence);
  }
  out += Term(
      "Model error, rms",
      fmt::format("How far the modelled output is from the measured one, as a root mean square over the {}.",
                  report.counted.one));
  return out + "</dl></div>\n";
}

}  // namespace

std::string FormatReport(const ReportInput& input) {
  const Report report = Prepare(input);
  const std::string verdicts = input.explanation_leads ? input.explanation_verdict + VerdictBox(report)
                                                       : VerdictBox(report) + input.explanation_verdict;
  const std::string body = Header(report) + input.drift_verdict + verdicts + Cards(report) + Tiles(report) +
                           Trends(report) + input.drift + ModelAgainstMeasurement(report) +
                           input.explanation + Skipped(report) + Method(report);
  return HtmlPage("Maintenance report: " + input.machine.name, "<main>" + body + "</main>\n");
}

Status WriteReport(const std::string& path, const ReportInput& input) {
  return WriteTextFile(path, FormatReport(input));
}

}  // namespace hydroscope
