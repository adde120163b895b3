#include "report/states_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/constants.h"
#include "core/contains.h"
#include "core/relative_change.h"
#include "models/counted_words.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "models/state_effects.h"
#include "report/error_map_plot.h"
#include "report/report_page.h"
#include "report/svg_rows.h"
#include "report/svg_text.h"
#include "report/unranked_effects.h"
#include "workbench/states/experiment_output.h"
#include "workbench/states/states_warnings.h"
#include "workbench/states/states_words.h"

namespace hydroscope {
namespace {

std::string Headline(const StatesExplained& e, const std::vector<Effect>& effects) {
  const StatesExplanation& x = e.explanation;
  std::vector<std::string> names;
  for (const std::string& id : x.set) names.push_back(NamedEffect(effects, id));
  switch (x.verdict) {
    case Verdict::kAdequate:
      if (e.slow()) return "△ What the model leaves lasts over many rows, and nothing in it predicts that";
      return x.runs.empty()
                 ? "✓ The model describes these episodes: nothing is missing in it"
                 : "△ The model describes short runs of these episodes; what adds up over a whole one is open";
    case Verdict::kNamed:
      return EscapeText(fmt::format("{}: {}",
                                    x.partial ? "△ Not proven: the model lacks this, or a relative of it"
                                              : "◆ The machine shows what the model lacks",
                                    fmt::join(names, " and ")));
    case Verdict::kAmbiguous:
      return "△ The model lacks something; these episodes cannot tell which of several effects";
    case Verdict::kUnknown:
      if (e.only_zeros()) return "? " + Told(kOnlyZeros).english;
      return x.astray ? "? The free run hardly follows what was measured: what it leaves tells of no effect"
             : x.only_doubtful() ? "? The model may lack something, and no effect it may be given explains it"
                                 : "? The model lacks something that no effect it may be given explains";
  }
  return "";
}

std::vector<std::string> Sentences(const StatesExplained& e, const std::vector<Effect>& effects) {
  const StatesExplanation& x = e.explanation;
  std::vector<std::string> out = {
      fmt::format("On pieces of the log it has not seen the model as it is errs by {}; {} {}.",
                  ErrorText(e.base, e.base.rms_holdout),
                  NoiseWords(!x.base_left.structured && !x.astray && !e.base.slow()),
                  ErrorText(e.base, e.base.noise_floor))};
  if (!x.final.added.empty())
    out.push_back(fmt::format("With {} it errs by {}.", fmt::join(x.final.added, " and "),
                              ErrorText(e.final, e.final.rms_holdout)));
  if (x.verdict == Verdict::kNamed)
    for (const std::string& id : x.set)
      if (const std::string plain = PlainWords(effects, id); !plain.empty()) out.push_back(plain);
  if (x.verdict == Verdict::kAmbiguous)
    for (const auto& group : x.groups) {
      std::vector<std::string> names;
      for (const std::string& id : group) names.push_back(NamedEffect(effects, id));
      out.push_back((names.size() > 1 ? "Possible – " : "Certain – ") +
                    fmt::format("{}", fmt::join(names, " or ")));
    }
  if (x.verdict == Verdict::kUnknown && !x.nearest.empty())
    out.push_back(fmt::format("Nearest, not proven – {}", fmt::join(x.nearest, ", ")));
  for (const std::string& warning : InEnglish(ExplainWarnings(e))) out.push_back(warning);
  if (const auto record = StatesToRecord(e)) out.push_back("To record next: " + record->english);
  for (std::string& sentence : out) sentence = EscapeText(sentence);
  return out;
}

std::string LeftOutLabel(const StatesExplained& e) {
  return fmt::format("error on pieces left out, rms ({})", ErrorWordsOf(e.base).unit);
}

std::string Staircase(const StatesExplained& e) {
  const StatesExplanation& x = e.explanation;
  if (x.steps.size() < 2) return "";
  const ErrorWords words = ErrorWordsOf(e.base);
  RowPlot plot;
  plot.title = "error on pieces left out, step by step";
  plot.x_label = LeftOutLabel(e);
  plot.bars = true;
  for (const auto& [added, error] : x.steps) {
    const double rms = words.factor * e.base.unit.factor * error;
    plot.rows.push_back({added.empty() ? "model as it is" : "+ " + added, rms, rms, rms, FormatShort(rms),
                         added.empty() ? Ink::kBlue : Ink::kGreen, added.empty()});
  }
  plot.level = words.factor * e.final.noise_floor;
  plot.level_label = NoiseWords(e.noise_alone());
  plot.note_width = 90;
  return "<h2>The error falls</h2>\n" +
         Figure(RenderRows(plot), "Error of the free run on pieces of the log that the fit did not see.");
}

/// The episode in which the model as it is errs most.
std::size_t WorstEpisode(const StateFit& fit) {
  std::size_t worst = 0;
  double most = -1;
  for (std::size_t e = 0; e < fit.residuals.size(); ++e) {
    const Eigen::VectorXd rms = RmsOf({fit.residuals[e]}, fit.model->output.rows).cwiseQuotient(fit.scale);
    if (rms.allFinite() && rms.maxCoeff() > most) most = rms.maxCoeff(), worst = e;
  }
  return worst;
}

/// One output of an episode: as measured, and as the free runs give it.
std::string CoursePlot(const StatesExplained& e, std::span<const Episode> episodes, std::size_t index,
                       int output) {
  const StateFit &base = e.explanation.base.fit, &extended = e.explanation.final.fit;
  const Episode& episode = episodes[index];
  const auto at = static_cast<std::size_t>(output);
  const std::string& name = base.model->machine.states.outputs[at].signal;
  const DisplayUnit unit = ShownUnit(base.model->machine, name);
  const auto shown = [&](double si) { return si * unit.factor + unit.offset; };
  std::vector<double> time, measured, as_it_is, with;
  for (int row = 0; row < episode.rows(); ++row) {
    time.push_back(episode.time[row] - episode.time.front());
    measured.push_back(shown(episode.signal(row, base.model->outputs[at])));
    as_it_is.push_back(shown(base.runs[index].outputs(row, output)));
    if (!e.explanation.final.added.empty()) with.push_back(shown(extended.runs[index].outputs(row, output)));
  }
  SvgPlot::Options options;
  options.width = kPageWidth;
  options.height = 260;
  options.title = name + ", measured and simulated";
  options.x_label = "time in the episode (s)";
  options.y_label = unit.name == "1" ? name : fmt::format("{} ({})", name, unit.name);
  SvgPlot plot(options);
  plot.Line(time, measured, {Ink::kNeutral, Dash::kSolid, 2.2}, "measured");
  plot.Line(time, as_it_is, {Ink::kVermillion, Dash::kDashed, 1.6}, "model as it is, running by itself");
  if (!with.empty())
    plot.Line(time, with, {Ink::kGreen, Dash::kSolid, 1.4},
              fmt::format("with {}", fmt::join(e.explanation.final.added, " and ")));
  return plot.Render();
}

std::string Courses(const StatesExplained& e) {
  const StatesExplanation& x = e.explanation;
  const std::vector<Episode>& episodes = x.runs.empty() ? e.log.episodes : x.runs;
  if (!x.base.fit.solved() || x.base.fit.runs.size() != episodes.size()) return "";
  const std::size_t worst = WorstEpisode(x.base.fit);
  std::string out;
  const std::string caption =
      episodes.size() == 1
          ? "The model runs by itself from the first row on."
          : fmt::format(
                "Episode {}, the one of the largest error: the model runs by itself from its first row on.",
                worst);
  for (int j = 0; j < x.base.fit.model->output.rows; ++j)
    out += Figure(CoursePlot(e, episodes, worst, j), j == 0 ? caption : "");
  return "<h2>Measured and simulated</h2>\n" + out;
}

std::string Locations(const StatesExplained& e) {
  std::string rows, maps;
  for (const OutputErrors& errors : e.located) {
    if (maps.empty() && !errors.location.pairs.empty())
      for (const bool diverging : {false, true})
        maps += Figure(
            ErrorMapPlot(errors.location.pairs.front(), errors.residuals.signals, errors.unit, diverging),
            diverging ? "Mean of measured minus simulated."
                      : fmt::format("Error of {} over the two signals that explain it best.", errors.output));
    for (const Located& l : errors.location.located)
      rows += fmt::format(
          "<tr><td>{}</td><td>{} from {} to {} {}</td><td class=\"number\">{} {}</td><td class=\"number\">{} %</td>"
          "<td class=\"number\">{} %</td></tr>",
          EscapeText(errors.output), EscapeText(l.signal), FormatShort(l.from), FormatShort(l.to),
          EscapeText(l.unit), FormatShort(l.rms * errors.unit.factor), errors.unit.name,
          FormatFixed(100 * l.share_error, 0), FormatFixed(100 * l.share_windows, 0));
  }
  if (maps.empty() && rows.empty()) return "";
  std::string out = "<h2>Where the model errs</h2>\n";
  if (!maps.empty()) out += "<div class=\"halves\">" + maps + "</div>\n";
  if (rows.empty()) return out + "<p class=\"note\">No range errs clearly more than the rest.</p>\n";
  return out +
         "<div class=\"sheet\"><table><tr><th>Output</th><th>The error sits at</th><th class=\"number\">error, "
         "rms</th><th class=\"number\">share of the error</th><th class=\"number\">share of the data</th></tr>" +
         rows + "</table></div>\n";
}

/// The law that no effect is, as a curve for a person to recognise.
std::string WhatIsMissing(const StatesExplained& e) {
  if (!e.missing) return "";
  const RemainderShape& shape = e.missing->shape;
  const EffectUnit& unit = e.missing->unit;
  std::vector<double> x, value, low, high;
  for (const ShapePoint& p : shape.points) {
    x.push_back(p.x);
    value.push_back(p.value * unit.factor);
    low.push_back((p.value - kNormal95 * p.std) * unit.factor);
    high.push_back((p.value + kNormal95 * p.std) * unit.factor);
  }
  SvgPlot::Options options;
  options.width = kPageWidth;
  options.title = "what is missing in the equation of " + e.missing->equation;
  options.x_label = shape.unit.empty() ? shape.signal : fmt::format("{} ({})", shape.signal, shape.unit);
  options.y_label = fmt::format("missing in {} ({})", e.missing->equation, unit.name);
  SvgPlot plot(options);
  plot.Band(x, low, high, Ink::kBlue, "95 % band");
  plot.Line(x, value, {Ink::kBlue, Dash::kSolid, 1.8}, "what would have to be added");
  plot.Level(0, {Ink::kNeutral, Dash::kDashed, 1}, "");
  return "<h2>The law that is missing</h2>\n" +
         Figure(
             plot.Render(),
             fmt::format(
                 "It predicts {} % of the error on pieces left out. A step at zero is dry friction, a straight "
                 "line damping or a leak, a flat middle a dead zone.",
                 FormatFixed(100 * shape.explained, 0)));
}

std::string Ranking(const StatesExplained& e) {
  const StatesExplanation& x = e.explanation;
  const ErrorWords words = ErrorWordsOf(e.base);
  RowPlot plot;
  plot.title = "every effect tried alone";
  plot.x_label = LeftOutLabel(e);
  plot.bars = true;
  plot.level = words.factor * e.base.rms_holdout;
  plot.level_label = "model as it is";
  for (const StateCandidate& candidate : x.ranking) {
    const std::string& id = candidate.added.front();
    if (x.not_seen.contains(id)) continue;
    const double rms = words.factor * ShownLeftOut(e, candidate);
    const bool chosen = Contains(x.set, id);
    plot.rows.push_back({id, rms, rms, rms,
                         FormatShort(rms) + (candidate.fitted() ? "" : " (by linearisation)"),
                         chosen ? Ink::kGreen : Ink::kNeutral, chosen});
  }
  std::vector<std::pair<std::string, std::string>> unranked;
  for (const auto& [id, seen] : x.not_seen) unranked.emplace_back(id, WhyNotSeen(x, id).english);
  std::string out;
  if (!plot.rows.empty())
    out = "<h2>Every effect, tried alone</h2>\n" +
          Figure(RenderRows(plot), "Error left when the effect is added, best first. Green: the verdict.");
  return out + UnrankedEffects(unranked);
}

std::string Parameters(const StatesExplained& e) {
  const bool extended = !e.explanation.final.added.empty();
  const MachineKind& kind = KindOf(e.log.machine);
  const auto shown = [&](const Estimate& estimate) {
    return EscapeText(
        ParameterWithInterval(kind, estimate.parameter, estimate.value, estimate.std, estimate.unit));
  };
  std::string out =
      "<h2>Parameters</h2><div class=\"sheet ids\"><table><tr><th></th><th class=\"number\">model as it is</th>";
  out += extended ? "<th class=\"number\">extended</th><th class=\"number\">moved by</th></tr>" : "</tr>";
  for (const Estimate& now : extended ? e.final_parameters : e.base_parameters) {
    const auto before = std::ranges::find_if(e.base_parameters,
                                             [&](const Estimate& b) { return b.parameter == now.parameter; });
    const bool known = before != e.base_parameters.end();
    out += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td>", EscapeText(now.parameter),
                       known ? shown(*before) : "–");
    if (extended) {
      const auto moved =
          known ? RelativeChange(before->value, before->std, now.value - before->value) : std::nullopt;
      out += fmt::format(
          "<td class=\"number\">{}</td><td class=\"number\">{}</td>", shown(now),
          moved && ToldInPercent(kind, now.parameter, now.unit) ? FormatSigned(100 * *moved, 1) + " %" : "");
    }
    out += "</tr>";
  }
  return out +
         "</table><p class=\"note\">± half of the 95 % interval, clustered by pieces of the log.</p></div>\n";
}

}  // namespace

Status WriteStatesReport(const std::string& path, const StatesExplained& e) {
  const std::vector<Effect> effects = StateEffectsOf(e.log.machine);
  const std::string head = fmt::format(
      "<header><div><h1>What the model misses: {}</h1><p class=\"soft\">{}, {} of {} rows used</p></div></header>\n",
      EscapeText(e.log.machine.name), CountedWordsOf(e.log.machine).Counted(e.log.episodes.size()),
      FormatCount(e.log.used), FormatCount(e.log.rows));
  return WritePage(path, "Hydroscope: what the model misses",
                   head + VerdictSection(e.explanation.verdict, Headline(e, effects), Sentences(e, effects)) +
                       Staircase(e) + Courses(e) + Locations(e) + WhatIsMissing(e) + Ranking(e) +
                       Parameters(e));
}

}  // namespace hydroscope
