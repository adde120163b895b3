#include "report/explain_report.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "core/constants.h"
#include "core/contains.h"
#include "core/interval_text.h"
#include "core/relative_change.h"
#include "diagnosis/doubts.h"
#include "models/machine.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "report/error_map_plot.h"
#include "report/report.h"
#include "report/report_page.h"
#include "report/report_plots.h"
#include "report/svg_rows.h"
#include "report/svg_text.h"
#include "report/unranked_effects.h"
#include "workbench/explain/explain_log.h"
#include "workbench/explain/explain_overlays.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/odd_text.h"
#include "workbench/explain/what_to_record.h"

namespace hydroscope {
namespace {

/// Model error energy left with a fit, in % of `base`, with its 95 % interval over the strokes.
PlotRow ErrorLeft(const ExtendedFit& fit, double base) {
  const double percent = 100 / base, half_width = kNormal95 * percent * ExcessStd(fit);
  PlotRow row;
  row.value = percent * fit.excess.sum();
  row.low = row.value - half_width;
  row.high = row.value + half_width;
  return row;
}

/// Whether the temperature, if it is one of the map's signals, moved enough to be worth an axis.
bool TemperatureMoves(const ErrorMap& map, const ExplainResult& result) {
  const std::vector<ResidualSignal>& signals = result.signals;
  constexpr double kWorthAnAxis = 2.0;  // K
  for (std::size_t axis = 0; axis < map.signals.size(); ++axis) {
    const int channel = signals[map.signals[axis]].channel;
    if (channel < 0 || channel != result.log.model->temperature_channel) continue;
    const std::vector<double> edges = MapEdges(map, signals, axis);
    if (edges.back() - edges.front() < kWorthAnAxis) return false;
  }
  return true;
}

/// Of the pairs that explain the error about equally well, the first whose signals move.
const ErrorMap& ShownPair(const ExplainResult& result) {
  constexpr double kEqual = 0.05;
  const std::vector<ErrorMap>& pairs = result.location.pairs;
  for (const ErrorMap& pair : pairs)
    if (pair.explained > pairs.front().explained - kEqual && TemperatureMoves(pair, result)) return pair;
  return pairs.front();
}

/// SVG: error on strokes left out, from the model as it is to the extended one, beside what sensor noise leaves.
std::string StaircasePlot(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  RowPlot plot;
  plot.title = "error on strokes left out, step by step";
  const DisplayUnit unit = OutputUnit(result.log.machine);
  plot.x_label = fmt::format("error on strokes left out, rms ({})", unit.name);
  plot.bars = true;
  for (const ExplainStep& step : x.steps) {
    const double rms = step.rms_holdout * unit.factor;
    plot.rows.push_back({step.added.empty() ? "model as it is" : "+ " + step.added, rms, rms, rms,
                         fmt::format("{} {}", FormatShort(rms), unit.name),
                         step.added.empty() ? Ink::kBlue : Ink::kGreen, step.added.empty()});
  }
  plot.level = x.final.noise_floor * unit.factor;
  plot.level_label = "sensor noise alone";
  plot.note_width = 90;
  return RenderRows(plot);
}

/// SVG: for every effect that can be tested, the model error left with it, in % of that of the model as it
/// is, with the 95 % interval over the strokes; best first.
std::string RankingPlot(const ExplainResult& result) {
  constexpr std::size_t kShown = 12;
  const Explanation& x = result.explanation;
  const double base = x.base.excess.sum();
  RowPlot plot;
  plot.title = "every effect tried alone";
  plot.x_label = "model error energy left (% of the model as it is; 95 % interval over the strokes)";
  plot.level = 100;
  plot.level_label = "model as it is";
  if (!(base > 0)) return "";
  for (const RankedEffect& ranked : x.ranking) {
    if (!ranked.fit.solved || !ranked.testable || plot.rows.size() >= kShown) continue;
    PlotRow row = ErrorLeft(ranked.fit, base);
    const EffectEstimate& size = ranked.fit.effects.back();
    const Effect& effect = result.effect(ranked.effect);
    const bool chosen = Contains(x.set, ranked.id);
    row.label = ranked.id;
    row.bold = chosen;
    // Blue is for what lowers the error beyond its scatter over the strokes: a bar that spans 100 % is not.
    const bool lowers = ranked.significant && row.high < plot.level;
    row.ink = chosen ? Ink::kGreen : lowers ? Ink::kBlue : Ink::kNeutral;
    row.note = fmt::format("{} = {}", effect.parameter, ShownWithInterval(size.size, size.std, effect.unit));
    plot.rows.push_back(std::move(row));
  }
  return plot.rows.empty() ? "" : RenderRows(plot);
}

/// SVG heat map: model error over the two signals that explain it best; "" without samples. `diverging`: mean
/// of measured minus modelled in place of the rms.
std::string ResidualMap(const ExplainResult& result, bool diverging) {
  if (result.location.pairs.empty() || result.signals.empty()) return "";
  return ErrorMapPlot(ShownPair(result), result.signals, OutputUnit(result.log.machine), diverging);
}

/// SVG of the versions of a model: error on strokes left out of those that were judged; "" if fewer than two were.
std::string HistoryPlot(const Machine& machine) {
  const std::vector<ModelRecord>& history = machine.model_history;
  RowPlot plot;
  plot.title = "versions of the model";
  DisplayUnit unit = DisplayUnitFor("m3/s");
  for (const ModelRecord& record : history)
    if (record.judged()) unit = UnitOfRecord(machine, record.unit);
  plot.x_label = fmt::format("error on strokes left out, rms ({})", unit.name);
  plot.bars = true;
  plot.label_width = 250;
  for (const ModelRecord& record : history) {
    if (!record.judged()) continue;
    const double rms = record.rms_holdout * unit.factor;
    plot.rows.push_back(
        {fmt::format("{}: {}", record.version, record.name), rms, rms, rms,
         fmt::format("{} {}, {} strokes of {}", FormatShort(rms), unit.name, record.strokes, record.source),
         Ink::kBlue, false});
    plot.level = record.noise_floor * unit.factor;
  }
  plot.level_label = "sensor noise alone";
  return plot.rows.size() < 2 ? "" : RenderRows(plot);
}

/// "<b>Internal leakage past the piston seal</b>: oil passes ...".
std::string DescribedInPage(const ExplainResult& result, const std::string& id) {
  const Effect* effect = result.FindEffect(id);
  if (effect == nullptr) return "<b>" + EscapeText(id) + "</b>";
  return fmt::format("<b>{}</b>: {}", EscapeText(effect->title), EscapeText(effect->plain));
}

std::string Headline(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  if (SwapLeads(x))
    return fmt::format("△ {}: {}", x.swap->proven ? "A wrong effect" : "Not proven: a wrong effect",
                       EscapeText(SwapTold(*x.swap).english));
  switch (x.verdict) {
    case Verdict::kAdequate:
      if (!x.odd_strokes.empty()) {
        const auto odd = ToldOddStrokesOf(result.log, x);
        return fmt::format("△ The model describes {} of {} strokes; {}",
                           result.strokes - IndicesOf(odd).size(), result.strokes,
                           EscapeText(WhichDiffer(result.log, odd).english));
      }
      return "✓ The model describes these strokes: nothing is missing in it";
    case Verdict::kNamed: {
      std::string names;
      for (std::size_t k = 0; k < x.set.size(); ++k) {
        const Effect* effect = result.FindEffect(x.set[k]);
        names += (k == 0                  ? ""
                  : k + 1 == x.set.size() ? " and "
                                          : ", ") +
                 EscapeText(effect != nullptr ? effect->title : x.set[k]);
      }
      return (WhyNotProven(x).empty() ? "◆ The machine shows what the model lacks: "
                                      : "△ Not proven: the model lacks this, or a relative of it: ") +
             names;
    }
    case Verdict::kAmbiguous:
      return WhyNotProven(x).empty()
                 ? "△ The model lacks something; these strokes cannot tell which of several effects"
                 : "△ Not proven: the model lacks something; these strokes cannot tell which of several effects";
    case Verdict::kUnknown:
      if (!x.no_verdict.empty()) return "? These strokes carry no verdict";
      if (x.may_be_noise) return fmt::format("? Something is left: {}", kNothingPredicts);
      if (x.small_error) return "? A small error is left, too little of it to name what causes it";
      return "? The model lacks something that no effect of the library explains";
  }
  return "";
}

std::string ErrorSentence(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const DisplayUnit unit = OutputUnit(result.log.machine);
  const auto shown = [&](double si) {
    return fmt::format("{} {}", FormatShort(si * unit.factor), unit.name);
  };
  std::string text =
      fmt::format("On strokes it has not seen the model errs by {}; sensor noise alone would cause {}.",
                  shown(x.base.rms_holdout), shown(result.base.noise_floor));
  if (x.steps.size() > 1)
    text +=
        fmt::format(" With {} it errs by {}.", x.steps.size() > 2 ? "the effects found" : "the effect found",
                    shown(x.final.rms_holdout));
  return text;
}

std::vector<std::string> Sentences(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  std::vector<std::string> out = {ErrorSentence(result)};
  if (!x.no_verdict.empty())
    out.insert(out.begin(), fmt::format("Why: {}.", EscapeText(x.no_verdict.english)));
  if (x.verdict == Verdict::kNamed)
    for (const std::string& id : x.set)
      out.push_back((!WhyNotProven(x).empty() ? "Check on the machine, this or a relative of it – "
                                              : "Check on the machine – ") +
                    DescribedInPage(result, id));
  for (const OddStrokes& odd : x.odd_strokes)
    out.push_back("Not everywhere – " + EscapeText(OddText(result, odd).english) + ".");
  if (!x.doubt.empty())
    out.push_back(fmt::format(
        "Not proven – {}.{}", EscapeText(x.doubt.english),
        x.unmeasured.empty() ? " The cause may be a relative that the library does not hold." : ""));
  if (x.verdict == Verdict::kAmbiguous)
    for (const auto& group : x.groups)
      for (const std::string& id : group)
        out.push_back((group.size() > 1 ? "Possible – " : "Certain – ") + DescribedInPage(result, id));
  if (x.verdict == Verdict::kUnknown && x.partial && !x.set.empty())
    out.push_back("Nearest, not proven – " + DescribedInPage(result, x.set.front()));
  if (x.verdict == Verdict::kUnknown)
    out.push_back(
        "Look at where the error lies (map below) and check the signals with <code>hydroscope check</code>.");
  if (const auto experiment = WhatToRecord(result))
    out.push_back("To record next: " + EscapeText(experiment->english));
  return out;
}

std::string Staircase(const ExplainResult& result) {
  if (result.explanation.steps.size() < 2) return "";
  return "<h2>The error falls</h2>\n" + Figure(StaircasePlot(result),
                                               "Error on strokes that the fit did not see. The dashed line "
                                               "is what sensor noise alone would leave; an "
                                               "effect that brings the error down to it is enough.");
}

std::string Overlays(const ExplainResult& result) {
  std::string out;
  for (const StrokeOverlay& overlay : ExplainOverlays(result))
    out += Figure(
        OverlayPlot(overlay),
        fmt::format(
            "Stroke {}, the one of {}. Time counts inside the gate. Below: what is left, with the band "
            "that holds 95 % of sensor noise.",
            FormatCount(overlay.sequence), overlay.label));
  return out.empty() ? "" : "<h2>Measured and modelled</h2>\n" + out;
}

std::string Maps(const ExplainResult& result) {
  const std::string rms = ResidualMap(result, false), mean = ResidualMap(result, true);
  if (rms.empty()) return "";
  const std::string& sign = result.log.model->words.sign.english;
  std::string out =
      "<h2>Where the model errs</h2>\n<div class=\"halves\">" +
      Figure(rms, "Model error with sensor noise taken out, over the two signals that explain it best.") +
      Figure(mean,
             "Mean of measured minus modelled" + (sign.empty() ? "." : ": the sign tells " + sign + ".")) +
      "</div>\n";
  if (result.location.located.empty())
    return out + "<p class=\"note\">No range errs clearly more than the rest.</p>\n";
  out +=
      "<div class=\"sheet\"><table><tr><th>The error sits at</th><th class=\"number\">error, rms</th>"
      "<th class=\"number\">share of the error</th><th class=\"number\">share of the data</th></tr>";
  const DisplayUnit unit = OutputUnit(result.log.machine);
  for (const Located& l : result.location.located)
    out += fmt::format(
        "<tr><td>{} from {} to {} {}</td><td class=\"number\">{} {}</td><td class=\"number\">{} %</td>"
        "<td class=\"number\">{} %</td></tr>",
        EscapeText(l.signal), FormatShort(l.from), FormatShort(l.to), EscapeText(l.unit),
        FormatShort(l.rms * unit.factor), unit.name, FormatFixed(100 * l.share_error, 0),
        FormatFixed(100 * l.share_windows, 0));
  return out + "</table></div>\n";
}

std::string Ranking(const ExplainResult& result) {
  std::string out =
      "<h2>Every effect, tried alone</h2>\n" +
      Figure(RankingPlot(result),
             "Model error left when the effect is added, on strokes left out; best first. 0 % is "
             "the level of sensor noise. Green: the verdict. Grey: not significant. Right: "
             "fitted size with its 95 % interval.");
  std::vector<std::pair<std::string, std::string>> unranked;
  for (const RankedEffect& ranked : result.explanation.ranking)
    if (!ranked.testable || !ranked.fit.solved) unranked.emplace_back(ranked.id, ranked.why_not.english);
  for (const UnmeasuredEffect& unmeasured : result.unmeasured)
    unranked.emplace_back(unmeasured.effect->id, WhyUnmeasured(unmeasured).english);
  return out + UnrankedEffects(unranked);
}

/// Parameters that effects could move which these strokes do not show.
std::string Confounded(const ExplainResult& result) {
  const bool extended = result.explanation.steps.size() > 1;
  std::string out;
  if (extended && !result.confounded.empty())
    out += fmt::format("<p class=\"note\"><b>Not identifiable, model as it is:</b> {}</p>",
                       EscapeText(ConfoundedNames(result.confounded)));
  for (const Confounding& c : result.extended_confounded)
    out += fmt::format("<p class=\"note\"><b>Not identifiable{}:</b> {}: {}; {}</p>",
                       extended ? ", extended" : "", EscapeText(c.parameter), EscapeText(c.reason.english),
                       EscapeText(c.advice.english));
  return out;
}

std::string Parameters(const ExplainResult& result) {
  const MachineKind& kind = KindOf(result.log.machine);
  const Explanation& x = result.explanation;
  const bool extended = x.steps.size() > 1;
  const std::vector<Estimate> after = result.ExtendedParameters();
  std::string out =
      "<h2>Parameters</h2><div class=\"sheet ids\"><table><tr><th></th><th class=\"number\">model as it is</th>";
  out += extended ? "<th class=\"number\">extended</th><th class=\"number\">moved by</th></tr>" : "</tr>";
  for (std::size_t i = 0; i < after.size(); ++i) {
    const Estimate& before = result.base.parameters[i];
    out += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{}</td>", EscapeText(before.parameter),
        EscapeText(ParameterWithInterval(kind, before.parameter, before.value, before.std, before.unit)));
    if (extended) {
      const auto moved = RelativeChange(before.value, before.std, after[i].value - before.value);
      out += fmt::format("<td class=\"number\">{}</td><td class=\"number\">{}</td>",
                         EscapeText(ParameterWithInterval(kind, before.parameter, after[i].value,
                                                          after[i].std, before.unit)),
                         moved && before.unit != "1" && ToldInPercent(kind, before.parameter, before.unit)
                             ? FormatSigned(100 * *moved, 1) + " %"
                             : "");
    }
    out += "</tr>";
  }
  for (std::size_t k = 0; k < x.final.effects.size(); ++k) {
    const EffectEstimate& e = x.final.effects[k];
    const Effect& effect = result.effect(e.choice.effect);
    const std::string size = EscapeText(ShownWithInterval(e.size, e.std, effect.unit));
    const bool present = static_cast<int>(k) < x.started;
    out += fmt::format("<tr><td>{}, {}</td><td class=\"number\">{}</td>", EscapeText(effect.parameter),
                       EscapeText(effect.id),
                       present && !extended ? size
                       : present            ? ""
                                            : "–");
    out += extended ? "<td class=\"number\">" + size + "</td><td></td></tr>" : "</tr>";
  }
  return out + "</table><p class=\"note\">± half of the 95 % interval, clustered by stroke.</p>" +
         Confounded(result) + "</div>\n";
}

std::string History(const ExplainResult& result) {
  const std::string plot = HistoryPlot(result.log.machine);
  return plot.empty() ? ""
                      : "<h2>Versions of the model</h2>\n" +
                            Figure(plot,
                                   "Error on strokes left out, from version to version. The dashed line is "
                                   "what sensor noise alone would leave.");
}

/// The verdict in a box, to lead a page; `lead` = sentence before it.
std::string VerdictBox(const ExplainResult& result, const std::string& lead = "") {
  std::vector<std::string> sentences = Sentences(result);
  if (!lead.empty()) sentences.insert(sentences.begin(), EscapeText(lead));
  return VerdictSection(result.explanation.verdict, Headline(result), sentences);
}

std::string VerdictBoxText(const ExplainResult& result) {
  if (!result.described.empty()) return EscapeText(result.described);
  return fmt::format("{} strokes, {} of {} rows used", FormatCount(static_cast<std::int64_t>(result.strokes)),
                     FormatCount(result.log.totals.used), FormatCount(result.log.totals.samples));
}

}  // namespace

void AddExplanation(const ExplainResult& result, const std::string& lead, ReportInput& report) {
  const bool adequate = result.explanation.verdict == Verdict::kAdequate;
  report.explanation_verdict = VerdictBox(result, lead);
  if (!result.explanation.no_verdict.empty()) {
    if (report.not_judged.empty()) report.not_judged = result.explanation.no_verdict.english;
  } else {
    report.found = adequate                          ? ErrorFinding::kNoise
                   : result.explanation.may_be_noise ? ErrorFinding::kMayBeNoise
                                                     : ErrorFinding::kMore;
  }
  report.explanation_leads = !adequate;
  report.explanation = ExplainSections(result, false);
}

std::string ExplainSections(const ExplainResult& result, bool overlays) {
  return Staircase(result) + (overlays ? Overlays(result) : "") + Maps(result) + Ranking(result) +
         Parameters(result) + History(result);
}

Status WriteExplainReport(const std::string& path, const std::vector<ExplainResult>& results) {
  std::string body;
  for (const ExplainResult& result : results) {
    body += fmt::format(
        "<header><div><h1>What the model misses: {}</h1><p class=\"soft\">{}</p></div></header>\n",
        EscapeText(result.log.machine.name), VerdictBoxText(result));
    body += VerdictBox(result) + ExplainSections(result);
  }
  return WritePage(path, "Hydroscope: what the model misses", body);
}

}  // namespace hydroscope
