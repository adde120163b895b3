#include "service/compare_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "service/explain_log.h"
#include "service/fit_output.h"
#include "service/located_output.h"

namespace hydroscope {
namespace {

constexpr double kLitresPerMinute = 6e4;
/// Chance of calling the residual correlated with any signal when it is not.
constexpr double kFamilyError = 0.01;
/// Flow error over the noise floor from which model error is seen with the eye.
constexpr double kVisible = 1.05;
/// p-value of the whiteness test below which a pattern in time is called model error.
constexpr double kPatternP = 1e-4;
constexpr std::size_t kPairMaps = 3;

bool IsSignificant(const CompareResult& result, const SignalCorrelation& c) {
  return c.p_value < kFamilyError / static_cast<double>(result.correlations.size());
}

double PercentOfSignal(const StrokeComparison& s) {
  return s.rms_measured > 0 ? 100 * s.rms_residual / s.rms_measured : 0.0;
}

/// rms of what is above the noise.
double ModelError(const StrokeComparison& s) {
  return std::sqrt(std::max(0.0, s.rms_residual * s.rms_residual - s.noise_floor * s.noise_floor));
}

std::vector<std::string> AddedEffects(const CompareResult& result) {
  std::vector<std::string> ids;
  for (const EffectChoice& choice : result.model.choices)
    ids.push_back(result.model.structure->effects[choice.effect]->id);
  return ids;
}

std::string OverallText(const CompareResult& result) {
  const StrokeComparison& o = result.overall;
  const std::vector<std::string> added = AddedEffects(result);
  std::string text = fmt::format("Model: {}{}, fitted to these strokes\n", result.log.machine.model,
                                 added.empty() ? "" : fmt::format(" with {}", fmt::join(added, ", ")));
  text += fmt::format("{} strokes, {} of {} rows used\n", result.strokes, result.log.totals.used,
                      result.log.totals.samples);
  if (result.strokes < result.log.strokes.size())
    text += fmt::format("The log is very long: compared on its first {} strokes of {}.\n", result.strokes,
                        result.log.strokes.size());
  text += fmt::format(
      "\nFlow, rms in l/min\n"
      "  measured               {:>8.3g}\n"
      "  modelled               {:>8.3g}\n"
      "  difference             {:>8.3g}   {:.2g} % of the measured flow\n"
      "  ... strokes left out   {:>8.3g}\n"
      "  sensor noise alone     {:>8.3g}\n"
      "  model error            {:>8.3g}   what is above the noise\n",
      o.rms_measured * kLitresPerMinute, o.rms_modelled * kLitresPerMinute, o.rms_residual * kLitresPerMinute,
      PercentOfSignal(o), result.model.fit.rms_holdout * kLitresPerMinute, o.noise_floor * kLitresPerMinute,
      ModelError(o) * kLitresPerMinute);
  return text;
}

std::string StrokesText(const CompareResult& result) {
  constexpr std::size_t kShown = 40;
  const std::size_t worst = result.WorstStroke();
  std::string text =
      "\nPer stroke, l/min\n  stroke   begin s  measured  modelled  difference   %      noise\n";
  for (std::size_t k = 0; k < result.per_stroke.size(); ++k) {
    if (k >= kShown && k != worst) continue;
    const StrokeComparison& s = result.per_stroke[k];
    text += fmt::format("  {:>6} {:>9.2f} {:>9.3g} {:>9.3g} {:>11.3g} {:>5.2g} {:>9.3g}{}\n", s.stroke,
                        s.begin, s.rms_measured * kLitresPerMinute, s.rms_modelled * kLitresPerMinute,
                        s.rms_residual * kLitresPerMinute, PercentOfSignal(s),
                        s.noise_floor * kLitresPerMinute, k == worst ? "   worst" : "");
  }
  if (result.per_stroke.size() > kShown)
    text +=
        fmt::format("  ... the first {} of {} strokes; --json has all\n", kShown, result.per_stroke.size());
  return text;
}

std::string WhitenessText(const CompareResult& result) {
  const Whiteness& w = result.whiteness;
  if (w.autocorrelation.empty()) return "";
  return fmt::format(
      "\nWhat is left, block by block\n"
      "  variance {:.3g} times that of sensor noise; correlation with the block before {:+.3f}\n"
      "  {} (Ljung-Box over {} lags, p = {:.2g})\n",
      w.variance_ratio, w.autocorrelation.front(),
      w.p_value < kPatternP ? "NOT WHITE: the rest has a pattern in time"
                            : "white: no pattern in time is left",
      w.lags, w.p_value);
}

std::string CorrelationsText(const CompareResult& result) {
  std::string text =
      "\nWhat the difference follows (error energy that each signal predicts on strokes left out)\n";
  for (const ErrorMap& map : result.location.single) {
    const int signal = map.signals.front();
    text += fmt::format("  {:<14} {:>4.0f} %", result.residuals.signals[signal].name,
                        100 * std::max(0.0, map.explained));
    for (const SignalCorrelation& c : result.correlations)
      if (c.signal == signal)
        text += fmt::format("   correlation {:+.2f}, p = {:.2g}{}", c.correlation, c.p_value,
                            IsSignificant(result, c) ? " *" : "");
    text += "\n";
  }
  if (!result.location.pairs.empty() && result.location.pairs.front().explained > 0) {
    const ErrorMap& pair = result.location.pairs.front();
    text += fmt::format("  {} and {} together: {:.0f} %\n", result.residuals.signals[pair.signals[0]].name,
                        result.residuals.signals[pair.signals[1]].name, 100 * pair.explained);
  }
  return text;
}

/// Whether there is more than noise: an error far above 0, one that is located, or a pattern in time.
bool HasModelError(const CompareResult& result) {
  return !result.location.located.empty() || result.location.excess > 4 * result.location.excess_std ||
         result.overall.rms_residual > kVisible * result.overall.noise_floor ||
         result.whiteness.p_value < kPatternP;
}

nlohmann::json StrokeJson(const StrokeComparison& s) {
  return {{"windows", s.windows},
          {"rms_measured", s.rms_measured * kLitresPerMinute},
          {"rms_modelled", s.rms_modelled * kLitresPerMinute},
          {"rms_residual", s.rms_residual * kLitresPerMinute},
          {"residual_percent", PercentOfSignal(s)},
          {"noise_floor", s.noise_floor * kLitresPerMinute},
          {"model_error", ModelError(s) * kLitresPerMinute}};
}

nlohmann::json StrokesJson(const CompareResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const StrokeComparison& s : result.per_stroke) {
    out.push_back(StrokeJson(s));
    out.back()["stroke"] = s.stroke;
    out.back()["begin"] = s.begin;
  }
  return out;
}

nlohmann::json CorrelationsJson(const CompareResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const SignalCorrelation& c : result.correlations)
    out.push_back({{"signal", result.residuals.signals[c.signal].name},
                   {"correlation", c.correlation},
                   {"p_value", c.p_value},
                   {"significant", IsSignificant(result, c)}});
  return out;
}

nlohmann::json MapsJson(const CompareResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const ErrorMap& map : result.location.single) out.push_back(MapJson(map, result.residuals.signals));
  for (std::size_t k = 0; k < std::min(kPairMaps, result.location.pairs.size()); ++k)
    out.push_back(MapJson(result.location.pairs[k], result.residuals.signals));
  return out;
}

}  // namespace

std::string CompareText(const CompareResult& result) {
  std::string text = HasModelError(result)
                         ? "The model misses something: the difference is more than sensor noise.\n"
                         : "The model describes these strokes down to the sensor noise.\n";
  text += OverallText(result) + StrokesText(result) + WhitenessText(result) + CorrelationsText(result) +
          LocatedText(result.location.located);
  if (HasModelError(result))
    text += "\nNext\n  Which physical effect it is: hydroscope explain, with the same log and machine file\n";
  return text;
}

nlohmann::json CompareJson(const CompareResult& result) {
  const Whiteness& w = result.whiteness;
  nlohmann::json out = StrokeJson(result.overall);
  out["unit"] = "l/min";
  out["strokes"] = result.strokes;
  out["strokes_in_log"] = result.log.strokes.size();
  out["model_error_seen"] = HasModelError(result);
  out["rms_holdout"] = result.model.fit.rms_holdout * kLitresPerMinute;
  out["effects"] = AddedEffects(result);
  out["parameters"] = ParametersJson(
      BaseParameters(*result.model.structure, result.model.fit, static_cast<int>(result.strokes)));
  out["per_stroke"] = StrokesJson(result);
  out["worst_stroke"] = result.per_stroke[result.WorstStroke()].stroke;
  out["whiteness"] = {
      {"lag1", w.autocorrelation.empty() ? nlohmann::json() : nlohmann::json(w.autocorrelation.front())},
      {"autocorrelation", w.autocorrelation},
      {"lags", w.lags},
      {"ljung_box", w.ljung_box},
      {"p_value", w.p_value},
      {"variance_ratio", w.variance_ratio}};
  out["correlations"] = CorrelationsJson(result);
  out["located"] = LocatedJson(result.location.located);
  out["maps"] = MapsJson(result);
  return out;
}

}  // namespace hydroscope
