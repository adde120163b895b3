#include "workbench/compare_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json_value.h"
#include "core/short_number.h"
#include "models/counted_words.h"
#include "models/output_unit.h"
#include "workbench/explain/explain_log.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/located_output.h"
#include "workbench/fit_output.h"

namespace hydroscope {
namespace {

/// In which the channel that the model runs by itself is shown.
DisplayUnit RunUnit(const CompareResult& result) {
  const auto& run = result.model.structure->free_run;
  return DisplayUnitFor(run ? run->si : "");
}

double LagSeconds(const CompareResult& result, const SignalCorrelation& c) {
  return c.lag * result.log.window.block * result.log.window.period;
}

double PercentOfRun(const CompareResult& result) {
  return result.rms_run > 0 ? 100 * *result.overall.free_run / result.rms_run : 0.0;
}

std::vector<std::string> AddedEffects(const CompareResult& result) {
  std::vector<std::string> ids;
  for (const EffectChoice& choice : result.model.choices)
    ids.push_back(result.model.structure->effects[choice.effect]->id);
  return ids;
}

/// Begins a line: a name that is the user's own stays as it is written.
std::string AtBegin(std::string word, const ModelStructure& model) {
  if (!model.kind->own_library && !word.empty())
    word[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
  return word;
}

/// Two digits; of shares of the whole and more all before the point.
std::string InPercent(double share) {
  return share < 0.995 ? fmt::format("{:.2g}", 100 * share) : fmt::format("{:.0f}", 100 * share);
}

/// "; 13 of 26 strokes" where others are left out.
std::string CoveredText(const CompareResult& result, std::string_view before) {
  const LeftOut left_out = result.left_out();
  if (left_out.odd == 0) return "";
  return fmt::format("{}{} of {}", before, left_out.described(),
                     CountedWordsOf(result.log.machine).Counted(left_out.strokes));
}

std::string OverallText(const CompareResult& result) {
  const StrokeComparison& o = result.overall;
  const std::vector<std::string> added = AddedEffects(result);
  const CountedWords counted = CountedWordsOf(result.log.machine);
  std::string text =
      fmt::format("Model: {}{}, fitted to {}\n", result.log.machine.model,
                  added.empty() ? "" : fmt::format(" with {}", fmt::join(added, ", ")),
                  result.odd.empty() ? fmt::format("these {}", counted.many) : CoveredText(result, ""));
  text += result.described.empty() ? fmt::format("{}, {} of {} rows used\n", counted.Counted(result.strokes),
                                                 result.log.totals.used, result.log.totals.samples)
                                   : result.described;
  for (const std::string& note : result.log.notes) text += "Note: " + note + "\n";
  if (result.strokes < result.log.strokes.size())
    text += fmt::format("The log is very long: compared on its first {} {} of {}.\n", result.strokes,
                        counted.many, result.log.strokes.size());
  const DisplayUnit unit = OutputUnit(result.log.machine);
  const MachineWords& words = result.log.model->words;
  text += fmt::format(
      "\n{}, rms in {}{}\n"
      "  measured               {:>8}\n"
      "  modelled               {:>8}\n"
      "  difference             {:>8}   {} % of the measured {}\n"
      "  ... {:<18} {:>8}\n"
      "  sensor noise alone     {:>8}\n"
      "  model error            {:>8}   what is above the noise\n",
      AtBegin(words.output.english, *result.log.model), unit.name, CoveredText(result, "; "),
      ShortNumber(o.rms_measured * unit.factor), ShortNumber(o.rms_modelled * unit.factor),
      ShortNumber(o.rms_residual * unit.factor), InPercent(o.relative_error()), words.output.english,
      fmt::format("{} left out", counted.many), ShortNumber(result.model.figures.rms_holdout * unit.factor),
      ShortNumber(o.noise_floor * unit.factor), ShortNumber(o.model_error() * unit.factor));
  if (result.held_out) text += "  " + HeldOutText(*result.held_out, unit);
  if (o.free_run) {
    const DisplayUnit run = RunUnit(result);
    const std::string& called = result.model.structure->free_run->called;
    text += fmt::format(
        "\n{} that the model runs by itself from the begin of each {}, rms in {}{}\n"
        "  measured               {:>8}\n"
        "  difference             {:>8}   {} % of the measured {}\n",
        AtBegin(called, *result.log.model), counted.one, run.name, CoveredText(result, "; "),
        ShortNumber(result.rms_run * run.factor, 4), ShortNumber(*o.free_run * run.factor),
        ShortNumber(PercentOfRun(result), 2), called);
  }
  return text;
}

std::string StrokesText(const CompareResult& result) {
  constexpr std::size_t kShown = 40;
  const std::size_t worst = result.WorstStroke();
  const DisplayUnit unit = OutputUnit(result.log.machine);
  const CountedWords counted = CountedWordsOf(result.log.machine);
  const DisplayUnit run = RunUnit(result);
  const bool runs = std::ranges::any_of(result.per_stroke,
                                        [](const StrokeComparison& s) { return s.free_run.has_value(); });
  const std::vector<std::size_t> odd = IndicesOf(result.odd);
  std::string text =
      fmt::format("\nPer {}, {}{}\n {:>7}  begin s  measured  modelled  difference   %      noise{}\n",
                  counted.one, unit.name, runs ? fmt::format("; free run in {}", run.name) : "", counted.one,
                  runs ? "  free run" : "");
  for (std::size_t k = 0; k < result.per_stroke.size(); ++k) {
    if (k >= kShown && k != worst) continue;
    const StrokeComparison& s = result.per_stroke[k];
    text += fmt::format(
        "  {:>6} {:>8} {:>9} {:>9} {:>11} {:>5} {:>9}{}{}\n", s.stroke,
        std::isfinite(s.begin) ? fmt::format("{:.2f}", s.begin) : std::string("-"),
        ShortNumber(s.rms_measured * unit.factor), ShortNumber(s.rms_modelled * unit.factor),
        ShortNumber(s.rms_residual * unit.factor), InPercent(s.relative_error()),
        ShortNumber(s.noise_floor * unit.factor),
        runs ? fmt::format(" {:>9}", s.free_run ? ShortNumber(*s.free_run * run.factor) : std::string("-"))
             : std::string(),
        std::string(std::ranges::binary_search(odd, k) ? " differs" : "") + (k == worst ? " worst" : ""));
  }
  if (result.per_stroke.size() > kShown)
    text += fmt::format("  ... the first {} of {} {}; --json has all\n", kShown, result.per_stroke.size(),
                        counted.many);
  return text;
}

std::string WhitenessText(const CompareResult& result) {
  const Whiteness& w = result.whiteness;
  if (w.autocorrelation.empty()) return "";
  const FloorTrust& floor = result.model.trust.floor;
  const char* pattern = floor.believable || floor.only_moves
                            ? "NOT WHITE: the rest has a pattern in time"
                            : "not white, but nor is the noise of these sensors: no proof of a model error";
  return fmt::format(
      "\nWhat is left, block by block{}\n"
      "  variance {:.3g} times that of sensor noise; correlation with the block before {:+.3f}\n"
      "  {} (Ljung-Box over {} lags, p = {:.2g})\n",
      CoveredText(result, "; "), w.variance_ratio, w.autocorrelation.front(),
      result.HasPattern() ? pattern : "white: no pattern in time is left", w.lags, w.p_value);
}

/// "; +0.31 when it follows 40 ms later", if that is clearly more than at the same time.
std::string LaggedText(const CompareResult& result, const SignalCorrelation& c) {
  if (!result.IsLagged(c)) return "";
  return fmt::format("; {:+.2f} when it {} by {:.0f} ms", c.lagged, c.lag > 0 ? "follows" : "precedes",
                     1e3 * std::abs(LagSeconds(result, c)));
}

std::string CorrelationsText(const CompareResult& result) {
  if (result.location.single.empty()) return "";
  std::string text = fmt::format(
      "\nWhat the difference follows (error energy that each signal predicts on strokes left out){}\n",
      CoveredText(result, "; "));
  for (const ErrorMap& map : result.location.single) {
    const int signal = map.signals.front();
    text += fmt::format("  {:<14} {:>4.0f} %", result.residuals.signals[signal].name,
                        100 * std::max(0.0, map.explained));
    for (const SignalCorrelation& c : result.correlations)
      if (c.signal == signal)
        text += fmt::format("   correlation {:+.2f}, p = {:.2g}{}{}", c.correlation, c.p_value,
                            result.IsSignificant(c) ? " *" : "", LaggedText(result, c));
    text += "\n";
  }
  if (!result.location.pairs.empty() && result.location.pairs.front().explained > 0) {
    const ErrorMap& pair = result.location.pairs.front();
    text += fmt::format("  {} and {} together: {:.0f} %\n", result.residuals.signals[pair.signals[0]].name,
                        result.residuals.signals[pair.signals[1]].name, 100 * pair.explained);
  }
  return text;
}

ModelHeadline HeadlineOfComparison(const CompareResult& result) {
  const ErrorFinding found = result.Found();
  const CountedWords counted = CountedWordsOf(result.log.machine);
  const Told no_verdict = result.verdict || found != ErrorFinding::kNoise
                              ? result.no_verdict
                              : TooFewForVerdict(result.strokes, counted);
  return HeadlineOf(result.model.figures, found, no_verdict, counted, result.left_out());
}

std::vector<std::string> Warnings(const CompareResult& result) {
  std::vector<std::string> warnings = result.warnings;
  if (const std::string impossible = ImpossibleFigures(result.model.figures).english; !impossible.empty())
    warnings.insert(warnings.begin(), impossible);
  return warnings;
}

nlohmann::json StrokeJson(const StrokeComparison& s, double factor, double run_factor) {
  return {{"windows", s.windows},
          {"rms_measured", s.rms_measured * factor},
          {"rms_modelled", s.rms_modelled * factor},
          {"rms_residual", s.rms_residual * factor},
          {"residual_percent", 100 * s.relative_error()},
          {"noise_floor", s.noise_floor * factor},
          {"model_error", s.model_error() * factor},
          {"free_run_bar", s.free_run ? nlohmann::json(*s.free_run * run_factor) : nlohmann::json()}};
}

nlohmann::json StrokesJson(const CompareResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const StrokeComparison& s : result.per_stroke) {
    out.push_back(StrokeJson(s, OutputUnit(result.log.machine).factor, RunUnit(result).factor));
    out.back()["stroke"] = s.stroke;
    if (!s.log.empty()) out.back()["log"] = s.log;
    out.back()["begin"] = JsonNumber(s.begin);
  }
  return out;
}

nlohmann::json CorrelationsJson(const CompareResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const SignalCorrelation& c : result.correlations)
    out.push_back({{"signal", result.residuals.signals[c.signal].name},
                   {"correlation", c.correlation},
                   {"p_value", c.p_value},
                   {"significant", result.IsSignificant(c)},
                   {"lag_s", LagSeconds(result, c)},
                   {"lagged", c.lagged},
                   {"lagged_p_value", c.lagged_p}});
  return out;
}

}  // namespace

std::string CompareText(const CompareResult& result) {
  const ModelHeadline headline = HeadlineOfComparison(result);
  std::string text = headline.text + "\n" + WarningsText(Warnings(result));
  text += OverallText(result) + StrokesText(result) + WhitenessText(result) + CorrelationsText(result) +
          LocatedText(result.location.located, OutputUnit(result.log.machine));
  if (headline.standing == ModelStanding::kMisses)
    text += "\nNext\n  Which physical effect it is: hydroscope explain, with the same arguments\n";
  if (headline.standing == ModelStanding::kDescribesSome)
    text += fmt::format(
        "\nNext\n  See what the odd {} have in common: product, speed, oil temperature, time since the start\n",
        CountedWordsOf(result.log.machine).many);
  return text;
}

nlohmann::json CompareJson(const CompareResult& result) {
  const Whiteness& w = result.whiteness;
  const DisplayUnit unit = OutputUnit(result.log.machine);
  nlohmann::json out = StrokeJson(result.overall, unit.factor, RunUnit(result).factor);
  out["unit"] = unit.name;
  out["strokes"] = result.strokes;
  out["strokes_described"] = result.left_out().described();
  out["strokes_in_log"] = std::max(result.strokes, result.log.strokes.size());
  out["free_run_percent"] = result.overall.free_run ? nlohmann::json(PercentOfRun(result)) : nlohmann::json();
  const ModelStanding standing = HeadlineOfComparison(result).standing;
  out["model_error_seen"] = standing == ModelStanding::kNotJudged
                                ? nlohmann::json()
                                : nlohmann::json(standing != ModelStanding::kDescribes);
  out["verdict"] = result.verdict ? nlohmann::json(VerdictName(*result.verdict)) : nlohmann::json();
  out["notes"] = result.log.notes;
  out["warnings"] = Warnings(result);
  out["noise"] = NoiseJson(result.model.trust.floor);
  out["sampling"] = SamplingJson(result.model.trust.rate, result.log.model.get());
  out["model_version"] = result.log.machine.model_version;
  out["odd_strokes"] = OddStrokesJson(result.log, result.odd);
  out["rms_holdout"] = result.model.figures.rms_holdout * unit.factor;
  out["held_out"] = result.held_out ? HeldOutJson(*result.held_out, unit) : nlohmann::json();
  out["effects"] = AddedEffects(result);
  out["parameters"] = ParametersJson(result.model.figures.parameters);
  out["per_stroke"] = StrokesJson(result);
  out["worst_stroke"] = result.per_stroke[result.WorstStroke()].stroke;
  if (w.autocorrelation.empty())
    out["whiteness"] = nullptr;
  else
    out["whiteness"] = {{"lag1", w.autocorrelation.front()},
                        {"autocorrelation", w.autocorrelation},
                        {"lags", w.lags},
                        {"ljung_box", w.ljung_box},
                        {"p_value", w.p_value},
                        {"variance_ratio", w.variance_ratio}};
  out["correlations"] = CorrelationsJson(result);
  out["located"] = LocatedJson(result.location.located, unit.factor);
  out["maps"] = MapsJson(result.location, result.residuals.signals, unit.factor);
  return out;
}

}  // namespace hydroscope
