#include "workbench/states/states_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/constants.h"
#include "core/counted_words.h"
#include "core/effect_units.h"
#include "core/interval_text.h"
#include "core/json_value.h"
#include "core/short_number.h"
#include "core/shown_width.h"
#include "models/machine_kind.h"
#include "models/state_effects.h"
#include "workbench/explain/located_output.h"
#include "workbench/explain/untested_text.h"
#include "workbench/fit_output.h"
#include "workbench/model/model_record.h"
#include "workbench/states/experiment_output.h"
#include "workbench/states/states_warnings.h"
#include "workbench/states/states_words.h"

namespace hydroscope {
namespace {

nlohmann::json ToldTogetherJson(const ToldTogether& together) {
  nlohmann::json std = nlohmann::json::object(), sensors = nlohmann::json::array();
  for (std::size_t k = 0; k < together.parameters.size(); ++k) std[together.parameters[k]] = together.std[k];
  for (const MissingSensor& sensor : together.sensors) {
    nlohmann::json with = nlohmann::json::object();
    for (std::size_t k = 0; k < together.parameters.size(); ++k) with[together.parameters[k]] = sensor.std[k];
    sensors.push_back({{"signal", sensor.signal}, {"relative_std", with}});
  }
  return {{"parameters", together.parameters}, {"relative_std", std}, {"sensors", sensors}};
}

/// What a parameter of a built-in machine is.
std::string Meaning(const Machine& machine, const std::vector<Effect>& effects,
                    const std::string& parameter) {
  if (const MachineParameter* known = FindParameter(KindOf(machine), parameter))
    return std::string(known->meaning);
  const Effect* effect = FindStateEffect(effects, parameter.substr(0, parameter.find('.')));
  return effect == nullptr ? "" : effect->title;
}

EffectUnit EstimateUnit(const Machine& machine, const Estimate& e) {
  const MachineParameter* known = FindParameter(KindOf(machine), e.parameter);
  // A rate constant is no drift, of which EffectUnitFor would tell per cent a minute.
  if (e.unit == "1/s" && (known == nullptr || known->shown.empty())) return {1, "1/s"};
  if (known == nullptr || known->shown.empty()) return EffectUnitFor(e.unit);
  return {known->factor, std::string(known->shown)};
}

std::string ParameterLines(const Machine& machine, const std::vector<Estimate>& parameters) {
  const std::vector<Effect> effects = StateEffectsOf(machine);
  std::size_t name_width = 6, value_width = 5, unit_width = 4;
  std::vector<std::string> values;
  for (const Estimate& e : parameters) {
    const EffectUnit unit = EstimateUnit(machine, e);
    values.push_back(FoundWithInterval(e.value * unit.factor, kNormal95 * e.std * unit.factor));
    name_width = std::max(name_width, e.parameter.size());
    value_width = std::max(value_width, ShownWidth(values.back()));
    unit_width = std::max(unit_width, unit.name.size());
  }
  std::string text;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Estimate& e = parameters[p];
    text += fmt::format("{:<{}} {:>{}} {:<{}} {}{}\n", e.parameter, name_width, values[p], value_width,
                        EstimateUnit(machine, e).name, unit_width, Meaning(machine, effects, e.parameter),
                        e.reason == EstimateReason::kUpdated          ? ""
                        : e.reason == EstimateReason::kOutsidePhysics ? " AT A LIMIT of its range"
                                                                      : " NOT IDENTIFIABLE with these data");
  }
  return text;
}

std::string StartsText(const StateFit& fit) {
  if (fit.starts_tried < 2) return "";
  std::string text = fmt::format("{}, {} of them in the best minimum", Counted(fit.starts_tried, "start"),
                                 fit.minima.empty() ? 0 : fit.minima.front().starts);
  if (fit.minima.size() > 1)
    text += fmt::format(", {} other minima (the next with {:.3g} times the error, {} starts)",
                        fit.minima.size() - 1, fit.minima[1].cost, fit.minima[1].starts);
  if (fit.starts_diverged > 0)
    text += fmt::format(", from {} the model diverges or runs far slower", fit.starts_diverged);
  return text + "\n";
}

std::string WarningLines(const std::vector<Told>& warnings) {
  std::string text;
  for (const std::string& warning : InEnglish(warnings)) text += fmt::format("WARNING: {}\n", warning);
  return text;
}

std::string RowsText(const EpisodeLog& log) {
  return fmt::format("{}, {} of {} rows used\n", kEpisodes.Counted(log.episodes.size()), log.used, log.rows);
}

std::string HeldOutLine(const StatesFit& fit) {
  if (!fit.held_out) return "";
  return fmt::format("free-run error on {}, held out: {}, {}\n", fit.held_out_log,
                     ErrorText(fit.error, *fit.held_out), kEpisodes.Counted(fit.held_out_episodes));
}

nlohmann::json OutputsJson(const StateFit& fit) {
  nlohmann::json out = nlohmann::json::object();
  for (int j = 0; j < fit.model->output.rows; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const SignalSpec& signal = fit.model->machine.signals[fit.model->outputs[at]];
    const auto unit = FindUnit(signal.unit);
    out[signal.name] = {{"rms_residual", fit.noise[j]},
                        {"rms_signal", fit.scale[j]},
                        {"unit", unit ? std::string(unit->si) : "1"}};
  }
  return out;
}

nlohmann::json MinimaJson(const StateFit& fit) {
  nlohmann::json out = nlohmann::json::array();
  for (const StateMinimum& minimum : fit.minima) {
    nlohmann::json values = nlohmann::json::object();
    for (Eigen::Index p = 0; p < minimum.parameters.size(); ++p)
      values[fit.model->parameters[p].name] = minimum.parameters[p];
    out.push_back({{"error_ratio", minimum.cost}, {"starts", minimum.starts}, {"parameters", values}});
  }
  return out;
}

nlohmann::json LeftJson(const StateRemainder& left) {
  return {{"share", left.share},           {"least_share", left.least_share}, {"p_value", left.p_value},
          {"null_share", left.null_share}, {"functions", left.functions},     {"about", left.about}};
}

nlohmann::json InitialJson(const StatesFit& fit) {
  nlohmann::json out = nlohmann::json::array();
  for (const Eigen::VectorXd& x0 : fit.fit.initial) {
    nlohmann::json states = nlohmann::json::object();
    for (int i = 0; i < fit.fit.model->states(); ++i)
      states[fit.fit.model->machine.states.states[i].name] = x0[i];
    out.push_back(states);
  }
  return out;
}

nlohmann::json HeldOutObject(const StatesFit& fit) {
  if (!fit.held_out) return nullptr;
  return {{"log", fit.held_out_log},
          {"strokes", fit.held_out_episodes},
          {"rms", *fit.held_out},
          {"unit", fit.error.unit.name}};
}

/// Rms of measured less modelled per episode, first output's unit or share of the variation.
nlohmann::json EpisodesJson(const StatesFit& fit) {
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t e = 0; e < fit.log.episodes.size(); ++e) {
    const Eigen::VectorXd rms = RmsOf({fit.fit.residuals[e]}, fit.fit.model->output.rows);
    const double overall =
        rms.size() == 1
            ? rms[0]
            : std::sqrt(rms.cwiseQuotient(fit.fit.scale).squaredNorm() / static_cast<double>(rms.size()));
    out.push_back({{"stroke", e},
                   {"begin", fit.log.episodes[e].time.front()},
                   {"rows", fit.log.episodes[e].rows()},
                   {"rms_residual", overall * fit.error.unit.factor}});
  }
  return out;
}

std::string VerdictText(const StatesExplained& e) {
  const StatesExplanation& x = e.explanation;
  const std::vector<Effect> effects = StateEffectsOf(e.log.machine);
  std::string text = fmt::format("Verdict: {}{}\n", VerdictName(x.verdict), x.partial ? ", partial" : "");
  switch (x.verdict) {
    case Verdict::kAdequate:
      if (e.slow())
        return text +
               "What is left lasts over many rows, and no function of states and inputs predicts it.\n";
      return text +
             fmt::format(
                 "The model describes {}: no function of states and inputs predicts what is left.\n",
                 x.runs.empty() ? "these episodes" : "short runs of these episodes, which is no all-clear");
    case Verdict::kNamed:
      for (const std::string& id : x.set) {
        text += "  " + NamedEffect(effects, id) + "\n";
        if (const std::string plain = PlainWords(effects, id); !plain.empty()) text += "    " + plain + "\n";
      }
      return text;
    case Verdict::kAmbiguous:
      for (const auto& group : x.groups) {
        std::vector<std::string> names;
        for (const std::string& id : group) names.push_back(NamedEffect(effects, id));
        text += fmt::format("  {}\n", fmt::join(names, " or "));
      }
      return text + "  These episodes do not tell them apart.\n";
    case Verdict::kUnknown:
      break;
  }
  if (e.only_zeros()) return text + Told(kOnlyZeros).english + "\n";
  text += x.astray ? "The free run hardly follows what was measured: what it leaves tells of no effect.\n"
          : x.only_doubtful() ? "Something may be missing, and no effect of the machine file explains it.\n"
                              : "An error is there, and no effect of the machine file explains it.\n";
  if (!x.nearest.empty()) text += fmt::format("Nearest, not proven: {}.\n", fmt::join(x.nearest, ", "));
  const std::string& about = x.final_left.about.empty() ? x.base_left.about : x.final_left.about;
  if (x.astray || about.empty()) return text;
  return text + fmt::format("What is left can be predicted best by a term in the equation of {}.\n", about);
}

nlohmann::json EffectParametersJson(const std::vector<Estimate>& estimates, const std::string& id) {
  nlohmann::json out = nlohmann::json::object();
  for (const Estimate& estimate : estimates)
    if (estimate.parameter.starts_with(id + "."))
      out[estimate.parameter.substr(id.size() + 1)] = {
          {"value", estimate.value}, {"std", estimate.std}, {"unit", estimate.unit}};
  return out;
}

std::vector<Estimate> BaseOnly(const std::vector<Estimate>& estimates) {
  std::vector<Estimate> out;
  for (const Estimate& estimate : estimates)
    if (estimate.parameter.find('.') == std::string::npos) out.push_back(estimate);
  return out;
}

/// What the linear form of the kind tells of the record: sums of parameters that it shows, what it does not.
std::vector<std::string> BaseParameterTexts(const StatesFit& fit) {
  std::vector<std::string> texts;
  const LinearForm form = LinearFormOf(fit.log.machine);
  for (std::size_t k = 0; k < fit.linear->base.kept.size(); ++k)
    texts.push_back(BaseParameterText(form, fit.linear->base, k));
  return texts;
}

std::vector<std::string> UnseenTexts(const StatesFit& fit) {
  std::vector<std::string> texts;
  const LinearForm form = LinearFormOf(fit.log.machine);
  for (const int column : fit.linear->base.unseen) texts.push_back(form.parameters[column]);
  return texts;
}

std::string LinearText(const StatesFit& fit) {
  if (!fit.linear) return "";
  if (!fit.linear->solved()) return fmt::format("base parameters: {}\n", fit.linear->failed);
  const auto unseen = UnseenTexts(fit);
  return fmt::format("base parameters: {}{}; condition of the record {:.1f}\n",
                     fmt::join(BaseParameterTexts(fit), ", "),
                     unseen.empty() ? "" : fmt::format("; not seen: {}", fmt::join(unseen, ", ")),
                     fit.linear->base.condition);
}

nlohmann::json LinearJson(const StatesFit& fit) {
  if (!fit.linear || !fit.linear->solved()) return nullptr;
  nlohmann::json parameters;
  for (std::size_t k = 0; k < fit.linear->parameters.size(); ++k)
    parameters[fit.linear->parameters[k]] = {{"value", fit.linear->value[k]}, {"std", fit.linear->std[k]}};
  return {{"base", BaseParameterTexts(fit)},
          {"not_seen", UnseenTexts(fit)},
          {"condition", fit.linear->base.condition},
          {"parameters", parameters}};
}

}  // namespace

std::string FitText(const StatesFit& fit) {
  const Machine& machine = fit.log.machine;
  std::string text = machine.model_version > 1 || !machine.added_effects.empty()
                         ? fmt::format("Model: {}, version {}, {}\n", machine.model, machine.model_version,
                                       ModelName(machine))
                         : "";
  text += "Parameters (± 95 %)\n" + ParameterLines(machine, fit.parameters);
  text += fmt::format("\nfree-run error on pieces left out {}, {} {}\n",
                      ErrorText(fit.error, fit.error.rms_holdout), NoiseWords(fit.noise_alone()),
                      ErrorText(fit.error, fit.error.noise_floor));
  return text + LinearText(fit) + RowsText(fit.log) + StartsText(fit.fit) + HeldOutLine(fit) +
         WarningLines(FitWarnings(fit)) + (fit.left.structured ? "'hydroscope explain' says what.\n" : "");
}

nlohmann::json FitJson(const StatesFit& fit) {
  return {{"parameters", ParametersJson(fit.parameters)},
          {"strokes", fit.log.episodes.size()},
          {"samples", fit.log.used},
          {"rows", fit.log.rows},
          {"rms_holdout", fit.error.rms_holdout},
          {"noise_floor", fit.error.noise_floor},
          {"unit", fit.error.unit.name},
          {"model_version", fit.log.machine.model_version},
          {"effects", fit.log.machine.added_effects},
          {"outputs", OutputsJson(fit.fit)},
          {"initial", InitialJson(fit)},
          {"minima", MinimaJson(fit.fit)},
          {"starts", fit.fit.starts_tried},
          {"starts_diverged", fit.fit.starts_diverged},
          {"predictable", LeftJson(fit.left)},
          {"method", fit.prediction ? "prediction" : "free_run"},
          {"told_together", ToldTogetherJson(fit.told_together)},
          {"held_out", HeldOutObject(fit)},
          {"linear", LinearJson(fit)},
          {"warnings", InEnglish(FitWarnings(fit))},
          {"german", {{"warnings", InGerman(FitWarnings(fit))}}}};
}

std::string CompareText(const StatesFit& fit) {
  std::string text =
      fit.left.structured
          ? "The model misses something: what it leaves can be predicted from states and inputs.\n"
      : fit.astray() ? "The model hardly follows what was measured.\n"
      : fit.dynamics
          ? "The model misses dynamics: what it leaves can be predicted from the past of inputs and states.\n"
      : fit.slow() ? "What is left lasts over many rows, and no function of states and inputs predicts it.\n"
      : fit.may_lack_law() ? "Something may be missing: what is left is no white noise, see the warning.\n"
      : fit.zeros
          ? "But for a constant, see the warning, the model describes these episodes; noise alone is left.\n"
          : "The model describes these episodes; noise alone is left.\n";
  for (const auto& [what, error] : std::initializer_list<std::pair<const char*, double>>{
           {"free run", fit.error.rms},
           {"on pieces left out", fit.error.rms_holdout},
           {NoiseWords(fit.noise_alone()), fit.error.noise_floor},
           {"one step ahead, from past errors", fit.error.one_step}})
    text += fmt::format("  {:<32} {}\n", what, ErrorText(fit.error, error));

  const auto& outputs = fit.log.machine.states.outputs;
  std::size_t width = 12;
  for (const auto& output : outputs) width = std::max(width, output.signal.size());
  for (int j = 0; j < fit.fit.noise.size(); ++j)
    text += fmt::format("  {:<{}} error {:.2g} % of its variation\n", outputs[j].signal, width,
                        100 * fit.fit.noise[j] / fit.fit.scale[j]);
  text += RowsText(fit.log) + HeldOutLine(fit) + WarningLines(FitWarnings(fit)) + LocatedText(fit.located);
  if (fit.left.structured)
    text += "\nNext\n  Which physical effect it is: hydroscope explain, with the same arguments\n";
  return text;
}

nlohmann::json CompareJson(const StatesFit& fit) {
  nlohmann::json out = FitJson(fit);
  out["rms_residual"] = fit.error.rms;
  out["free_run"] = fit.error.rms;
  out["one_step"] = fit.error.one_step;
  out["model_error_seen"] =
      fit.astray() ? nlohmann::json() : nlohmann::json(fit.left.structured || fit.dynamics);
  out["per_stroke"] = EpisodesJson(fit);
  out["located"] = LocatedJson(fit.located);
  out["maps"] = MapsJson(fit.located);
  return out;
}

namespace {

std::string NotSeenText(const StatesExplanation& x) {
  std::vector<std::pair<std::string, std::string>> why_not;
  for (const auto& [id, seen] : x.not_seen) why_not.emplace_back(id, WhyNotSeen(x, id).english);
  return UntestedText(why_not, "episodes");
}

nlohmann::json MissingJson(const StatesExplained& e) {
  if (!e.missing) return nullptr;
  nlohmann::json out = RemainderJson(e.missing->shape, e.missing->unit.factor);
  out["equation"] = e.missing->equation;
  out["value_unit"] = e.missing->unit.name;
  return out;
}

}  // namespace

std::string ExplainText(const StatesExplained& e) {
  const StatesExplanation& x = e.explanation;
  std::string text = VerdictText(e);
  text +=
      fmt::format("Free-run error on pieces left out {}, {} {}.\n", ErrorText(e.final, e.final.rms_holdout),
                  NoiseWords(e.noise_alone()), ErrorText(e.final, e.final.noise_floor));
  text += RowsText(e.log);
  const std::vector<Told> warnings = ExplainWarnings(e);
  const ErrorWords words = ErrorWordsOf(e.base);
  text += WarningLines(warnings) + fmt::format("\nHow the error falls ({})\n", words.unit);
  for (const auto& [added, error] : x.steps)
    text += fmt::format("  {:<28} {:>9}\n", added.empty() ? "as it is" : "+ " + added,
                        ShortNumber(words.factor * e.base.unit.factor * error));
  text += "\nParameters (± 95 %)\n" + ParameterLines(e.log.machine, e.final_parameters);
  if (!x.ranking.empty())
    text += fmt::format("\nSingle effects, best first ({}; ~ by linearisation)\n", words.unit);
  for (const StateCandidate& candidate : x.ranking)
    if (!x.not_seen.contains(candidate.added.front()))
      text +=
          fmt::format("  {:<28} {:>9}{}\n", candidate.added.front(),
                      ShortNumber(words.factor * ShownLeftOut(e, candidate)), candidate.fitted() ? "" : " ~");
  text += NotSeenText(x) + LocatedText(e.located);
  if (e.missing)
    text +=
        RemainderText(e.missing->shape, e.missing->unit.factor, e.missing->unit.name, e.missing->equation);
  text += RecordTable(e);
  const std::optional<Told> record = StatesToRecord(e);
  if (x.verdict != Verdict::kNamed && !record) return text;
  text += "\nNext\n";
  if (x.verdict == Verdict::kNamed)
    for (const std::string& id : x.set)
      text += fmt::format("  Make it part of the model: hydroscope model add {} {}\n", id, e.target);
  if (record) text += fmt::format("  {}\n", record->english);
  return text;
}

nlohmann::json ExplainJson(const StatesExplained& e) {
  const StatesExplanation& x = e.explanation;
  nlohmann::json ranking = nlohmann::json::array(), steps = nlohmann::json::array(),
                 effects = nlohmann::json::object();
  for (const StateCandidate& c : x.ranking) {
    const bool seen = !x.not_seen.contains(c.added.front());
    ranking.push_back(
        {{"effect", c.added.front()},
         {"rms_holdout", ShownLeftOut(e, c)},
         {"p_value", std::erfc(std::max(0.0, c.t) / std::sqrt(2.0))},
         {"testable", seen},
         {"why_not", seen ? nlohmann::json() : nlohmann::json(WhyNotSeen(x, c.added.front()).english)},
         {"german", {{"why_not", WhyNotSeen(x, c.added.front()).german}}},
         {"fitted", c.fitted()},
         {"parameters",
          c.fitted() ? EffectParametersJson(EstimatesOf(c.fit), c.added.front()) : nlohmann::json::object()},
         {"gain", c.gain}});
  }
  for (const auto& [added, error] : x.steps)
    steps.push_back({{"added", JsonOrNull(added)}, {"rms_holdout", e.base.unit.factor * error}});
  const std::optional<Told> record = StatesToRecord(e);
  for (const std::string& id : x.final.added) effects[id] = EffectParametersJson(e.final_parameters, id);
  const std::vector<Told> warnings = ExplainWarnings(e);
  return {{"schema", 2},
          {"verdict", VerdictName(x.verdict)},
          {"set", x.set},
          {"groups", x.groups},
          {"partial", x.partial},
          {"slow", e.slow()},
          {"short_runs", !x.runs.empty()},
          {"astray", x.astray},
          {"doubtful", x.only_doubtful()},
          {"only_zeros", e.only_zeros()},
          {"nearest", x.nearest},
          {"warnings", InEnglish(warnings)},
          {"german", {{"warnings", InGerman(warnings)}, {"experiment", record ? record->german : ""}}},
          {"noise_floor", e.final.noise_floor},
          {"noise_at_most", !e.noise_alone()},
          {"strokes", e.log.episodes.size()},
          {"unit", e.base.unit.name},
          {"base",
           {{"rms_holdout", e.base.rms_holdout},
            {"noise_floor", e.base.noise_floor},
            {"parameters", ParametersJson(e.base_parameters)}}},
          {"ranking", ranking},
          {"steps", steps},
          {"predictable", {{"base", LeftJson(x.base_left)}, {"final", LeftJson(x.final_left)}}},
          {"final",
           {{"rms_holdout", e.final.rms_holdout},
            {"noise_floor", e.final.noise_floor},
            {"parameters", ParametersJson(BaseOnly(e.final_parameters))},
            {"effects", effects}}},
          {"odd_strokes", nlohmann::json::array()},
          {"located", LocatedJson(e.located)},
          {"remainder", MissingJson(e)},
          {"experiment", record ? nlohmann::json(record->english) : nlohmann::json()},
          {"experiment_plan", ExperimentPlanJson(e)}};
}

}  // namespace hydroscope
