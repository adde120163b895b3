#include <nlohmann/json.hpp>

#include "core/json_value.h"
#include "diagnosis/effect_ranking.h"
#include "models/output_unit.h"
#include "workbench/explain/drift_text.h"
#include "workbench/explain/explain_output.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/located_output.h"
#include "workbench/explain/odd_text.h"
#include "workbench/explain/relative_text.h"
#include "workbench/explain/what_to_record.h"
#include "workbench/fit_output.h"

namespace hydroscope {
namespace {

constexpr int kExplainSchema = 2;  ///< 2: `schema` and `warnings`

double Factor(const ExplainResult& result) { return OutputUnit(result.log.machine).factor; }

nlohmann::json EffectParameters(const Effect& effect, const EffectEstimate& estimate,
                                const std::vector<double>& nonlinear) {
  nlohmann::json out = {
      {effect.parameter, {{"value", estimate.size}, {"std", estimate.std}, {"unit", effect.unit}}}};
  for (std::size_t i = 0; i < nonlinear.size() && i < effect.nonlinear.size(); ++i)
    out[effect.nonlinear[i].name] = {
        {"value", nonlinear[i]},
        {"std",
         i < estimate.nonlinear_std.size() ? nlohmann::json(estimate.nonlinear_std[i]) : nlohmann::json()},
        {"unit", effect.nonlinear[i].unit}};
  return out;
}

nlohmann::json RankedJson(const ExplainResult& result, const RankedEffect& ranked) {
  nlohmann::json out = {
      {"effect", ranked.id},
      {"rms_holdout", nullptr},
      {"p_value", ranked.p_value},
      {"testable", ranked.testable},
      {"parameters", nlohmann::json::object()},
      {"why_not", ranked.why_not.empty() ? nlohmann::json() : nlohmann::json(ranked.why_not.english)},
      {"german", {{"why_not", ranked.why_not.german}}},
      {"gain", ranked.gain},
      {"significant", ranked.significant}};
  if (!ranked.fit.solved) return out;
  out["rms_holdout"] = ranked.fit.rms_holdout * Factor(result);
  out["parameters"] =
      EffectParameters(result.effect(ranked.effect), ranked.fit.effects.back(), ranked.nonlinear);
  return out;
}

nlohmann::json RankingJson(const ExplainResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const RankedEffect& ranked : result.explanation.ranking) out.push_back(RankedJson(result, ranked));
  for (const UnmeasuredEffect& unmeasured : result.unmeasured) {
    const Told why = WhyUnmeasured(unmeasured);
    out.push_back({{"effect", unmeasured.effect->id},
                   {"rms_holdout", nullptr},
                   {"p_value", 1.0},
                   {"testable", false},
                   {"parameters", nlohmann::json::object()},
                   {"why_not", why.english},
                   {"german", {{"why_not", why.german}}},
                   {"gain", 0.0},
                   {"significant", false}});
  }
  return out;
}

nlohmann::json StepsJson(const ExplainResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const ExplainStep& step : result.explanation.steps)
    out.push_back({{"added", JsonOrNull(step.added)},
                   {"rms_holdout", step.rms_holdout * Factor(result)},
                   {"excess_ratio", step.excess_ratio}});
  return out;
}

nlohmann::json FoundEffectsJson(const ExplainResult& result, const ExtendedFit& fit) {
  nlohmann::json effects = nlohmann::json::object();
  for (const EffectEstimate& estimate : fit.effects) {
    const Effect& effect = result.effect(estimate.choice.effect);
    effects[effect.id] = EffectParameters(effect, estimate, result.NonlinearOf(estimate.choice));
  }
  return effects;
}

/// In words, what moved during the log, by effect.
std::map<std::string, Told> DriftsOf(const ExplainResult& result, const ExtendedFit& fit) {
  std::map<std::string, Told> drifts;
  for (const EffectEstimate& estimate : fit.effects)
    if (const Told drift = DriftText(result, estimate); !drift.empty())
      drifts[result.effect(estimate.choice.effect).id] = drift;
  return drifts;
}

nlohmann::json TextsJson(const std::map<std::string, Told>& texts, std::string Told::*language) {
  nlohmann::json out = nlohmann::json::object();
  for (const auto& [key, told] : texts) out[key] = told.*language;
  return out;
}

nlohmann::json FinalJson(const ExplainResult& result) {
  const ExtendedFit& fit = result.explanation.final;
  nlohmann::json parameters = ParametersJson(result.ExtendedParameters());
  AddConfoundings(result.extended_confounded, parameters);
  const std::map<std::string, Told> drifts = DriftsOf(result, fit);
  return {{"rms_holdout", fit.rms_holdout * Factor(result)},
          {"excess_ratio", fit.excess_ratio},
          {"parameters", std::move(parameters)},
          {"effects", FoundEffectsJson(result, fit)},
          {"drifts", TextsJson(drifts, &Told::english)},
          {"german", {{"drifts", TextsJson(drifts, &Told::german)}}}};
}

nlohmann::json SwapJson(const ExplainResult& result) {
  const std::optional<EffectSwap>& swap = result.explanation.swap;
  if (!swap) return nullptr;
  return {{"out", swap->out},
          {"in", swap->in},
          {"rms_holdout_before", swap->rms_before * Factor(result)},
          {"rms_holdout_after", swap->rms_after * Factor(result)},
          {"explains", swap->explains},
          {"proven", swap->proven}};
}

nlohmann::json IntervalUnitJson(const StrokeClusters& clusters) {
  return {{"unit", ClusterUnitName(clusters.unit)}, {"count", clusters.count}};
}

nlohmann::json PlanJson(const Experiment& experiment) {
  if (!experiment.proposed()) return nullptr;
  nlohmann::json plan = {{"strokes", experiment.strokes},
                         {"seconds", experiment.seconds},
                         {"separation", experiment.separation},
                         {"left", experiment.left}};
  for (std::size_t k = 0; k < experiment.levels.size(); ++k) {
    const StrokeSetting& setting = experiment.kind->experiment.settings[k];
    const std::vector<double>& levels = experiment.levels[k];
    plan[setting.levels] = levels;
    if (!setting.range) plan[setting.levels] = levels.empty() ? 0.0 : levels.front();
    if (!setting.unit_key.empty()) plan[setting.unit_key] = setting.si;
  }
  return plan;
}

/// The same of a machine of the user's own.
nlohmann::json PlanJson(const SignalExperiment& experiment) {
  if (experiment.strokes == 0) return nullptr;
  nlohmann::json signals = nlohmann::json::array();
  for (const SignalLevels& s : experiment.signals) {
    nlohmann::json levels = nlohmann::json::array();
    for (const auto& [low, high] : s.levels) levels.push_back({low, high});
    signals.push_back({{"signal", s.signal}, {"speed", s.speed}, {"levels", levels}});
  }
  return {{"strokes", experiment.strokes},
          {"signals", signals},
          {"seconds", experiment.seconds},
          {"separation", experiment.separation},
          {"separation_now", experiment.separation_now}};
}

/// With `unknown`: effects that lower the error, though not to the floor.
std::vector<std::string> NearestEffects(const Explanation& x) {
  std::vector<std::string> ids;
  for (std::size_t k = 1; x.verdict == Verdict::kUnknown && x.partial && k < x.steps.size(); ++k)
    ids.push_back(x.steps[k].added);
  return ids;
}

/// What is sure of effects that are not proven.
nlohmann::json RelativesJson(const ExplainResult& result) {
  nlohmann::json out = nlohmann::json::array();
  for (const Relative& relative : RelativesOf(result))
    out.push_back({{"effect", relative.id},
                   {"sentence", relative.sentence.english},
                   {"german", {{"sentence", relative.sentence.german}}}});
  return out;
}

nlohmann::json ProposedLawsJson(const ExplainResult& result) {
  nlohmann::json out = nlohmann::json::array();
  if (result.explanation.verdict != Verdict::kUnknown) return out;
  for (const ProposedLaw& law : result.explanation.proposed) {
    const Told late = LateSignal(law);
    out.push_back({{"expression", law.expression},
                   {"rms_holdout", law.rms_holdout * Factor(result)},
                   {"excess_ratio", law.excess_ratio},
                   {"late_signal", JsonOrNull(law.late_signal)},
                   {"sentence", late.english},
                   {"german", {{"sentence", late.german}}}});
  }
  return out;
}

/// Sizes that tests off the log gave.
nlohmann::json MeasuredJson(const ExplainResult& result) {
  nlohmann::json out = nlohmann::json::object();
  for (const auto& [id, known] : result.explanation.measured)
    if (const Effect* effect = result.FindEffect(id))
      out[id] = {{"value", known.size}, {"std", known.std}, {"unit", effect->unit}};
  return out;
}

/// Of each group the effects that no stroke like these tells apart, together.
nlohmann::json ClassesJson(const Explanation& x) {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& group : x.groups) out.push_back(ClassesOf(x, group));
  return out;
}

nlohmann::json CauseKindJson(const Explanation& x) {
  const CauseKind kind = CauseKindOf(x);
  return kind == CauseKind::kNotSought ? nlohmann::json() : nlohmann::json(CauseKindName(kind));
}

/// What could be predicted of an error on strokes left out.
nlohmann::json PredictableJson(const Predictability& left) {
  if (!left.tested) return nullptr;
  return {{"share", left.share},
          {"p_value", left.p_value},
          {"null_share", left.null_share},
          {"about", left.about}};
}

}  // namespace

nlohmann::json ExplainJson(const ExplainResult& result) {
  const Explanation& x = result.explanation;
  const std::optional<Told> experiment = WhatToRecord(result);
  nlohmann::json parameters = ParametersJson(result.base.parameters);
  AddConfoundings(result.confounded, parameters);
  return {
      {"schema", kExplainSchema},
      {"verdict", VerdictName(x.verdict)},
      {"set", x.set},
      {"groups", x.groups},
      {"classes", ClassesJson(x)},
      {"cause_kind", CauseKindJson(x)},
      {"partial", x.partial},
      {"may_be_noise", x.may_be_noise},
      {"small_error", x.small_error},
      {"doubt", x.doubt.empty() ? nlohmann::json() : nlohmann::json(x.doubt.english)},
      {"warnings", InEnglish(x.warnings)},
      {"notes", result.log.notes},
      {"german",
       {{"doubt", x.doubt.german},
        {"warnings", InGerman(x.warnings)},
        {"experiment", experiment ? experiment->german : ""}}},
      {"noise", NoiseJson(result.trust.floor)},
      {"sampling", SamplingJson(result.trust.rate, result.log.model.get())},
      {"noise_floor", x.final.noise_floor * Factor(result)},
      {"strokes", result.strokes},
      {"strokes_in_log", result.log.strokes.size()},
      {"unit", OutputUnit(result.log.machine).name},
      {"base",
       {{"rms_holdout", result.base.rms_holdout * Factor(result)},
        {"noise_floor", result.base.noise_floor * Factor(result)},
        {"excess_ratio", x.base.excess_ratio},
        {"parameters", std::move(parameters)},
        {"effects", FoundEffectsJson(result, x.base)}}},
      {"ranking", RankingJson(result)},
      {"nearest", NearestEffects(x)},
      {"relatives", RelativesJson(result)},
      {"proposed_laws", ProposedLawsJson(result)},
      {"measured", MeasuredJson(result)},
      {"odd_strokes", OddStrokesJson(result.log, ToldOddStrokesOf(result.log, result.explanation))},
      {"predictable", {{"base", PredictableJson(x.base_left)}, {"final", PredictableJson(x.final_left)}}},
      {"noise_scale", x.noise_scale},
      {"steps", StepsJson(result)},
      {"swap", SwapJson(result)},
      {"interval_units", IntervalUnitJson(x.final.clusters)},
      {"final", FinalJson(result)},
      {"located", LocatedJson(result.location.located, Factor(result))},
      {"remainder", result.remainder ? RemainderJson(*result.remainder, Factor(result)) : nlohmann::json()},
      {"experiment", experiment ? nlohmann::json(experiment->english) : nlohmann::json()},
      {"experiment_plan", result.signal_experiment.inputs.empty() ? PlanJson(result.experiment)
                                                                  : PlanJson(result.signal_experiment)}};
}

}  // namespace hydroscope
