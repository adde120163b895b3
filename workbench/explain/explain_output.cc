#include "workbench/explain/explain_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>

#include "core/constants.h"
#include "core/contains.h"
#include "core/effect_units.h"
#include "core/interval_text.h"
#include "core/records/quality.h"
#include "core/relative_change.h"
#include "core/short_number.h"
#include "core/units.h"
#include "diagnosis/doubts.h"
#include "diagnosis/effect_ranking.h"
#include "models/counted_words.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "workbench/explain/drift_text.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/located_output.h"
#include "workbench/explain/odd_text.h"
#include "workbench/explain/relative_text.h"
#include "workbench/explain/untested_text.h"
#include "workbench/explain/what_to_record.h"

namespace hydroscope {
namespace {

constexpr double kDrowns = 1.02;      // error over noise floor, below which single equations do not show it
constexpr double kMovedShown = 0.01;  // of a parameter: less than the per cent that is printed

/// "Internal leakage past the piston seal (internal_leakage)" and, indented, what to look for, where that is told.
std::string Described(const ExplainResult& result, const std::string& id) {
  const Effect* effect = result.FindEffect(id);
  if (effect == nullptr) return "  " + id + "\n";
  const std::string name = effect->title == id ? id : fmt::format("{} ({})", effect->title, id);
  return fmt::format("  {}\n", name) + (effect->plain.empty() ? "" : "    " + effect->plain + "\n");
}

std::string ErrorSentence(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const DisplayUnit unit = OutputUnit(result.log.machine);
  std::string text =
      fmt::format("On {} it has not seen the model errs by {} {}; sensor noise alone would cause {} {}.",
                  CountedWordsOf(result.log.machine).many, ShortNumber(x.base.rms_holdout * unit.factor),
                  unit.name, ShortNumber(result.base.noise_floor * unit.factor), unit.name);
  if (x.steps.size() > 1)
    text += fmt::format(" Extended, it errs by {} {}.", ShortNumber(x.final.rms_holdout * unit.factor),
                        unit.name);
  if (x.verdict != Verdict::kAdequate && x.no_verdict.empty() && !x.may_be_noise &&
      x.base.rms_holdout < kDrowns * result.base.noise_floor)
    text += fmt::format(" In single values it drowns in the noise; summed over the {} it stands out.",
                        CountedWordsOf(result.log.machine).many);
  return text + "\n";
}

/// What moved during the log, as a verdict says it first.
std::string DriftsText(const ExplainResult& result) {
  std::string text;
  for (const EffectEstimate& estimate : result.explanation.final.effects)
    if (const std::string drift = DriftText(result, estimate).english; !drift.empty())
      text += fmt::format("  {}.\n", drift);
  return text;
}

std::string NamedText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const bool one = x.set.size() == 1;
  const std::string missing = one ? "one effect" : fmt::format("{} effects at once", x.set.size());
  std::string text = !WhyNotProven(x).empty()
                         ? fmt::format("NAMED, NOT PROVEN: the model misses {}, {}.\n", missing,
                                       one ? "this or a relative of it" : "these or relatives of them")
                         : fmt::format("NAMED: the model misses {}.\n", missing);
  for (const std::string& id : x.set) text += Described(result, id);
  return text + DriftsText(result);
}

std::string AmbiguousText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const auto is_one = [&](const auto& group) { return ClassesOf(x, group).size() == 1; };
  const char* proven = WhyNotProven(x).empty() ? "" : ", NOT PROVEN";
  std::string text =
      std::ranges::all_of(x.groups, is_one)
          ? fmt::format(
                "NAMED{}, BUT FOR A TEST OFF THE LOG: the model misses something, and it is known what, as far as strokes tell.\n",
                proven)
          : fmt::format(
                "AMBIGUOUS{}: the model misses something, and these {} cannot tell which of several effects it is.\n",
                proven, CountedWordsOf(result.log.machine).many);
  for (const auto& group : x.groups) {
    text += group.size() == 1 ? "Certain:\n"
            : is_one(group)   ? "One of these, which no stroke like these tells apart:\n"
                              : "One of these, best first:\n";
    for (const std::string& id : group) text += Described(result, id);
  }
  return text + DriftsText(result);
}

/// What the error of the model as it is goes with, and where most of it lies.
std::string WhereItLies(const ExplainResult& result) {
  const Predictability& left = result.explanation.base_left;
  if (!left.IsStructured({})) return "";
  std::string text = fmt::format("  What is missing goes with {}: {:.0f} % of the error's energy", left.about,
                                 100 * left.share);
  if (!result.location.located.empty()) {
    const Located& most = result.location.located.front();
    text += fmt::format(", most of it at {} {} ... {} {}", most.signal, ShortNumber(most.from),
                        ShortNumber(most.to), most.unit);
  }
  return text + ".\n";
}

/// What is sure of an effect that is not proven, as a sentence.
std::string RelativesText(const ExplainResult& result) {
  std::string text;
  for (Relative& relative : RelativesOf(result)) {
    std::string& sentence = relative.sentence.english;
    sentence.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(sentence.front())));
    text += fmt::format("  PARTIAL: {}.\n", sentence);
  }
  return text;
}

std::string UnknownText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  if (!x.no_verdict.empty())
    return fmt::format("UNKNOWN: these {} carry no verdict, see the warning.\n",
                       CountedWordsOf(result.log.machine).many);
  if (x.may_be_noise)
    return fmt::format("UNKNOWN: {}.\n  {}\n  Why: {}.\n", kNothingPredicts,
                       WhatItMayBe(CountedWordsOf(result.log.machine)), x.doubt.english);
  std::string text = x.small_error
                         ? "UNKNOWN: a small error is left, too little of it to name what causes it.\n"
                         : "UNKNOWN: the model misses something, and no effect of the library explains it.\n";
  text += WhereItLies(result);
  if (!x.partial && !x.doubt.empty()) text += fmt::format("  Why: {}.\n", x.doubt.english);
  if (!x.partial || x.steps.size() < 2) return text;
  text += RelativesText(result);
  std::vector<std::string> tried;
  for (std::size_t k = 1; k < x.steps.size(); ++k) tried.push_back(x.steps[k].added);
  return text + fmt::format("  {} lowers the error, but {}, so the name is not proven.\n",
                            fmt::join(tried, " with "),
                            x.doubt.empty() ? "more than noise is left" : x.doubt.english);
}

/// Laws that may be missing in the machine file, and how to have one tried.
std::string ProposedText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  if (x.verdict != Verdict::kUnknown || x.proposed.empty()) return "";
  const DisplayUnit unit = OutputUnit(result.log.machine);
  std::string text = fmt::format("\nWhat is missing may go with {}; the error on {} left out would be, {}\n",
                                 x.proposed.size() == 1 ? "this" : "one of these",
                                 CountedWordsOf(result.log.machine).many, unit.name);
  for (const ProposedLaw& law : x.proposed) {
    text += fmt::format("  {:<30} {:>8}\n", law.expression, ShortNumber(law.rms_holdout * unit.factor));
    if (const Told late = LateSignal(law); !late.empty()) text += fmt::format("    {}\n", late.english);
  }
  const auto physics = std::ranges::find(x.proposed, "", &ProposedLaw::late_signal);
  if (physics == x.proposed.end()) return text;
  return text + fmt::format(
                    "  If physics of the machine goes so, write it into the machine file and explain again:\n"
                    "    [[effect]]\n    id = \"NAME\"\n    terms = {{ k = \"{}\" }}\n",
                    physics->expression);
}

/// Why a set is not proven, if so.
std::string DoubtText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  if (x.doubt.empty()) return "";
  std::string text = RelativesText(result) + fmt::format("  Not proven: {}.", x.doubt.english);
  if (x.unmeasured.empty())
    text += fmt::format(" The cause may be a relative of {} that the library does not hold.",
                        x.set.size() == 1 ? "this effect" : "these effects");
  return text + "\n";
}

/// What is not so in all strokes.
std::string OddStrokesText(const ExplainResult& result) {
  std::string text;
  for (const OddStrokes& odd : result.explanation.odd_strokes)
    text +=
        fmt::format("  NOT ALL {}: {}.\n", InEpisodes(KindOf(result.log.machine)) ? "EPISODES" : "STROKES",
                    OddText(result, odd).english);
  return text;
}

/// What tests off the log said.
std::string MeasuredText(const ExplainResult& result) {
  std::string text;
  for (const auto& [id, known] : result.explanation.measured)
    if (const Effect* effect = result.FindEffect(id)) {
      const EffectUnit unit = EffectUnitFor(effect->unit);
      text +=
          fmt::format("Measured off the log: {} {} {}.\n", id,
                      WithInterval(known.size * unit.factor, kNormal95 * known.std * unit.factor), unit.name);
    }
  return text;
}

/// An effect of the model that another one explains better, before what would be missing beside it.
std::string SwapVerdictText(const ExplainResult& result) {
  const EffectSwap& swap = *result.explanation.swap;
  std::string text = fmt::format("{}{}: {}.\n", swap.in.empty() ? "TAKE OUT" : "SWAP",
                                 swap.proven ? "" : ", NOT PROVEN", SwapTold(swap).english);
  for (const std::string& id : swap.in) text += Described(result, id);
  return text;
}

std::string VerdictText(const ExplainResult& result) {
  if (SwapLeads(result.explanation)) return SwapVerdictText(result);
  switch (result.explanation.verdict) {
    case Verdict::kAdequate:
      if (!result.explanation.odd_strokes.empty())
        return "ADEQUATE, but for some strokes: the model describes all others.\n";
      return fmt::format("ADEQUATE: the model describes these {}; nothing stands out of the sensor noise.\n",
                         CountedWordsOf(result.log.machine).many);
    case Verdict::kNamed:
      return NamedText(result) + DoubtText(result);
    case Verdict::kAmbiguous:
      return AmbiguousText(result) + DoubtText(result);
    case Verdict::kUnknown:
      return UnknownText(result);
  }
  return "";
}

std::string StepsText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  constexpr int kBarWidth = 36;
  const DisplayUnit unit = OutputUnit(result.log.machine);
  const double scale = kBarWidth / std::max(x.base.rms_holdout, x.final.noise_floor);
  const auto line = [&](const std::string& name, double rms, char mark) {
    const int bar = static_cast<int>(std::lround(rms * scale));
    return fmt::format("  {:<30} {:>8}  {}\n", name, ShortNumber(rms * unit.factor),
                       std::string(std::clamp(bar, 0, 60), mark));
  };
  std::string text =
      fmt::format("\nError on {} left out, {}\n", CountedWordsOf(result.log.machine).many, unit.name);
  for (const ExplainStep& step : x.steps)
    text += line(step.added.empty() ? "model as it is" : "+ " + step.added, step.rms_holdout, '#');
  return text + line("sensor noise alone", x.final.noise_floor, '.');
}

std::string ParametersText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const bool extended = !x.final.effects.empty();
  const std::vector<Estimate> after = result.ExtendedParameters();
  std::string text =
      fmt::format("\nParameters, ± 95 % interval\n  {:<6} {:>22}", "", extended ? "model as it is" : "");
  text += extended ? fmt::format(" {:>22}\n", "extended") : "\n";
  for (std::size_t i = 0; i < after.size(); ++i) {  // sizes of effects come below
    const Estimate& before = result.base.parameters[i];
    const DisplayUnit unit = ParameterUnit(KindOf(result.log.machine), before.parameter, before.unit);
    const auto shown = [&](const Estimate& e) {
      return WithInterval(e.value * unit.factor + unit.offset, kNormal95 * e.std * unit.factor);
    };
    text += fmt::format("  {:<6} {:>23}", before.parameter, shown(before));
    if (extended) text += fmt::format(" {:>23}", shown(after[i]));
    text += fmt::format("  {}", unit.name);
    const auto moved =
        extended ? RelativeChange(before.value, before.std, after[i].value - before.value) : std::nullopt;
    const bool in_percent =
        before.unit != "1" && ToldInPercent(KindOf(result.log.machine), before.parameter, before.unit);
    if (moved && in_percent && std::abs(*moved) >= kMovedShown)
      text += fmt::format("  {:+.0f} %", 100 * *moved);
    const bool below = FindConfounding(result.confounded, before.parameter) != nullptr;
    if (!extended && before.reason != EstimateReason::kUpdated)
      text += fmt::format("  {}", below ? "NOT IDENTIFIABLE" : ReasonText(before.reason));
    text += "\n";
  }
  return text;
}

/// Parameters of the model that effects could move which these strokes do not show.
std::string ConfoundedText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const bool extended = x.final.effects.size() > x.base.effects.size();
  std::string text;
  if (extended && !result.confounded.empty())
    text += fmt::format("  NOT IDENTIFIABLE, model as it is: {}\n", ConfoundedNames(result.confounded));
  for (const Confounding& c : result.extended_confounded)
    text += fmt::format("  NOT IDENTIFIABLE{}: {}: {}; {}\n", extended ? ", extended" : "", c.parameter,
                        c.reason.english, c.advice.english);
  return text;
}

std::string SizeText(const Effect& effect, const EffectEstimate& estimate,
                     const std::vector<double>& nonlinear) {
  const EffectUnit unit = EffectUnitFor(effect.unit);
  const auto behind = [](const EffectUnit& u) { return u.name == "-" ? "" : " " + u.name; };
  std::string text = fmt::format(
      "{} = {}{}", effect.parameter,
      WithInterval(estimate.size * unit.factor, kNormal95 * estimate.std * unit.factor), behind(unit));
  // A law with one parameter has told it already.
  for (std::size_t i = 0; i < nonlinear.size() && i < effect.nonlinear.size(); ++i) {
    const bool square = effect.unit == effect.nonlinear[i].unit + "2";
    if (effect.implied && !square) continue;
    const EffectUnit shown = EffectUnitFor(effect.nonlinear[i].unit);
    const bool known = i < estimate.nonlinear_std.size() && estimate.nonlinear_std[i] > 0;
    const std::string value = known ? WithInterval(nonlinear[i] * shown.factor,
                                                   kNormal95 * estimate.nonlinear_std[i] * shown.factor)
                                    : ShortNumber(nonlinear[i] * shown.factor);
    // The interval of the size is that at this very shape where the shape has none.
    text += fmt::format("{} {} {}{}",
                        known    ? ","
                        : i == 0 ? " at"
                                 : " and",
                        effect.nonlinear[i].name, value, behind(shown));
  }
  return text;
}

/// Of an ambiguous verdict the extended model holds one effect of each group; with another its parameters are others.
std::string RivalsText(const Explanation& x) {
  std::string text;
  for (const auto& group : x.groups)
    if (group.size() > 1)
      text += fmt::format("  Extended by {}; by {} in its place it has other parameters.\n", group.front(),
                          fmt::join(group.begin() + 1, group.end(), " or "));
  return text;
}

/// Sizes of the effects: those the model has already, then "+" those found.
std::string AddedText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  std::string text;
  for (std::size_t k = 0; k < x.final.effects.size(); ++k) {
    const EffectEstimate& estimate = x.final.effects[k];
    const Effect& effect = result.effect(estimate.choice.effect);
    text += fmt::format("  {} {}: {}\n", static_cast<int>(k) < x.started ? " " : "+", effect.id,
                        SizeText(effect, estimate, result.NonlinearOf(estimate.choice)));
  }
  return text;
}

std::string RankingText(const ExplainResult& result) {
  if (result.explanation.ranking.empty()) return "";
  const DisplayUnit unit = OutputUnit(result.log.machine);
  std::string text = fmt::format("\nEvery effect tried alone, best first\n  {:<28} {:>7} {:>9}  {}\n", "",
                                 "error", "evidence", "size, ± 95 %");
  for (const RankedEffect& ranked : result.explanation.ranking) {
    if (!ranked.testable || !ranked.fit.solved) continue;
    text += fmt::format("{} {:<28} {:>7} {:>9.0f}  {}\n", ranked.significant ? "*" : " ", ranked.id,
                        ShortNumber(ranked.fit.rms_holdout * unit.factor), ranked.gain,
                        SizeText(result.effect(ranked.effect), ranked.fit.effects.back(), ranked.nonlinear));
  }
  return text + fmt::format(
                    "  error in {}; evidence: error energy removed on strokes left out, in "
                    "noise variances; * stands out\n",
                    unit.name);
}

/// Effects that were tried and whose best size is none that physics allows.
std::string RuledOutText(const Explanation& x) {
  std::vector<std::string> ids;
  for (const RankedEffect& ranked : x.ranking)
    if (ranked.testable && !ranked.fit.solved && !Contains(x.set, ranked.id)) ids.push_back(ranked.id);
  return ids.empty()
             ? ""
             : fmt::format("  not seen (they would fit only with a sign or size physics forbids): {}\n",
                           fmt::join(ids, ", "));
}

std::string UntestableText(const ExplainResult& result) {
  std::vector<std::pair<std::string, std::string>> why_not;
  for (const RankedEffect& ranked : result.explanation.ranking)
    if (!ranked.testable) why_not.emplace_back(ranked.id, ranked.why_not.english);
  for (const UnmeasuredEffect& unmeasured : result.unmeasured)
    why_not.emplace_back(unmeasured.effect->id, WhyUnmeasured(unmeasured).english);
  return UntestedText(why_not, CountedWordsOf(result.log.machine).many);
}

/// An effect of the model that was added wrongly, and what does better.
std::string SwapText(const ExplainResult& result) {
  const std::optional<EffectSwap>& swap = result.explanation.swap;
  if (!swap) return "";
  const DisplayUnit unit = OutputUnit(result.log.machine);
  std::string text = swap->in.empty()
                         ? fmt::format("  Take {} out", swap->out)
                         : fmt::format("  Replace {} by {}", swap->out, fmt::join(swap->in, " and "));
  text +=
      fmt::format(": error {} -> {} {} on strokes left out\n", ShortNumber(swap->rms_before * unit.factor),
                  ShortNumber(swap->rms_after * unit.factor), unit.name);
  text += fmt::format("    hydroscope model remove {} {}\n", swap->out, result.target);
  for (const std::string& id : swap->in)
    text += fmt::format("    hydroscope model add {} {}\n", id, result.target);
  return text;
}

/// Which strokes were left out together for the intervals, where single ones are not independent.
std::string IntervalUnitText(const StrokeClusters& clusters, const CountedWords& counted) {
  if (clusters.unit == ClusterUnit::kStroke) return "";
  const char* what = clusters.unit == ClusterUnit::kLog    ? "of one log"
                     : clusters.unit == ClusterUnit::kTime ? "that follow one another"
                                                           : "at one operating point";
  return fmt::format("  {}s {} err alike: the intervals come from leaving out {} groups of them in turn.\n",
                     counted.capital, what, clusters.count);
}

std::string NextText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  std::string text = "\nNext\n";
  const std::optional<Told> experiment = WhatToRecord(result);
  if (experiment) text += fmt::format("  {}\n", experiment->english);
  if (const std::string arguments = MeasuredArguments(result); !arguments.empty())
    text += fmt::format("  What a test gave is told with {}\n", arguments);
  text += SwapText(result);
  if (!x.odd_strokes.empty())
    return text +
           "  See what the odd strokes have in common: product, speed, oil temperature, time since the start.\n";
  if (x.swap && (x.verdict == Verdict::kNamed || SwapLeads(x)))
    text += "  Then explain again: what is named here is named beside the effect that goes.\n";
  else if (x.verdict == Verdict::kNamed)
    for (const std::string& id : x.set)
      text += fmt::format("  Make it part of the model: hydroscope model add {} {}\n", id, result.target);
  if (x.verdict == Verdict::kAdequate && !experiment && !result.confounded.empty())
    text += fmt::format("  To identify what is {}: {}.\n", ConfoundedNames(result.confounded),
                        result.confounded.front().advice.english);
  else if (x.verdict == Verdict::kAdequate && !experiment)
    text += "  Nothing to do: watch the parameters with 'hydroscope replay'.\n";
  if (x.verdict == Verdict::kUnknown && KindOf(result.log.machine).has_states)
    return text +
           "  Which effect it is: hydroscope explain LOG... --machine FILE, with the logs of these episodes and the "
           "machine file; effects of a machine with states are tried on logs.\n";
  if (x.verdict == Verdict::kUnknown)
    text +=
        "  Look at where the error lies with 'hydroscope compare', and check the signals with 'hydroscope check'.\n";
  return text;
}

/// Rows left out because an expression of the machine file failed on them.
std::string NotFiniteText(const StrokeCounters& totals) {
  const std::int64_t rows = totals.flagged[std::countr_zero(quality::kExpression)];
  if (rows == 0) return "";
  return fmt::format(
      "{} rows left out: an expression of the machine file is no finite number there (division by zero, root "
      "of a negative value); 'hydroscope check' says where.\n",
      rows);
}

}  // namespace

std::string ExplainText(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const DisplayUnit unit = OutputUnit(result.log.machine);
  const CountedWords counted = CountedWordsOf(result.log.machine);
  std::string text =
      VerdictText(result) + OddStrokesText(result) + MeasuredText(result) + ErrorSentence(result);
  text += result.described.empty() ? fmt::format("{}, {} of {} rows used.\n", counted.Counted(result.strokes),
                                                 result.log.totals.used, result.log.totals.samples)
                                   : result.described;
  for (const std::string& note : result.log.notes) text += "Note: " + note + "\n";
  text += NotFiniteText(result.log.totals);
  for (const std::string& warning : InEnglish(x.warnings)) text += fmt::format("WARNING: {}\n", warning);
  if (result.strokes < result.log.strokes.size())
    text += fmt::format("The log is very long: explained from its first {} {} of {}.\n", result.strokes,
                        counted.many, result.log.strokes.size());
  if (!result.log.machine.added_effects.empty())
    text += fmt::format("The model as it is has these effects already: {}.\n",
                        fmt::join(result.log.machine.added_effects, ", "));
  return text + ProposedText(result) + StepsText(result) + ParametersText(result) + AddedText(result) +
         RivalsText(x) + ConfoundedText(result) +
         IntervalUnitText(x.final.clusters, CountedWordsOf(result.log.machine)) + RankingText(result) +
         RuledOutText(x) + UntestableText(result) + LocatedText(result.location.located, unit) +
         (result.remainder ? RemainderText(*result.remainder, unit.factor, unit.name) : "") +
         NextText(result);
}

}  // namespace hydroscope
