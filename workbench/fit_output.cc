#include "workbench/fit_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/counted_words.h"
#include "core/interval_text.h"
#include "core/short_number.h"
#include "core/shown_width.h"
#include "core/units.h"
#include "models/machine_kind.h"
#include "models/output_unit.h"
#include "models/parameter_unit.h"
#include "workbench/explain/headline.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

std::string Meaning(const FitResult& result, const std::string& parameter) {
  if (const MachineParameter* known = FindParameter(*result.log.model->kind, parameter))
    return std::string(known->meaning);
  for (const auto& effect : result.log.model->effects)
    if (parameter == effect->id + "." + effect->parameter) return effect->title;
  return "";
}

std::string WhyNot(const FitResult& result, const Estimate& e) {
  const Confounding* confounding = FindConfounding(result.confounded, e.parameter);
  if (e.reason != EstimateReason::kConfounded) return ReasonText(e.reason);
  if (confounding == nullptr)
    return fmt::format("{}; vary {}", ReasonText(e.reason), result.log.model->words.vary.english);
  return confounding->reason.english + "; " + confounding->advice.english;
}

std::vector<std::string> Warnings(const FitResult& result) {
  const std::string impossible = ImpossibleFigures(result.fit).english;
  return impossible.empty() ? std::vector<std::string>{} : std::vector<std::string>{impossible};
}

}  // namespace

std::string FitText(const FitResult& result) {
  const Machine& machine = result.log.machine;
  std::size_t width = 6, unit_width = 6;
  for (const Estimate& e : result.fit.parameters) {
    width = std::max(width, e.parameter.size());
    unit_width = std::max(unit_width, ShownWidth(ParameterUnit(KindOf(machine), e.parameter, e.unit).name));
  }
  std::string text = machine.model_version > 1 || !machine.added_effects.empty()
                         ? fmt::format("Model: {}, version {}, {}\n", machine.model, machine.model_version,
                                       ModelName(machine))
                         : "";
  text += fmt::format("{:<{}} {:>11} {:>25}  unit\n", "", width, "value", "95 % interval");
  for (const Estimate& e : result.fit.parameters) {
    const DisplayUnit unit = ParameterUnit(KindOf(machine), e.parameter, e.unit);
    const int digits = DigitsFor(e.value, kNormal95 * e.std);
    const auto shown = [&](double si) { return ShortNumber(si * unit.factor + unit.offset, digits); };
    const bool trusted = e.reason == EstimateReason::kUpdated;
    text += fmt::format("{:<{}} {:>11} {:>11} ... {:<10} {:<{}} {}{}\n", e.parameter, width, shown(e.value),
                        shown(e.value - kNormal95 * e.std), shown(e.value + kNormal95 * e.std), unit.name,
                        unit_width, Meaning(result, e.parameter),
                        !result.trust.rate.fast_enough
                            ? fmt::format("; NOT TO BE TRUSTED: {}", result.trust.rate.why.english)
                        : trusted ? ""
                                  : fmt::format("; NOT IDENTIFIABLE: {}", WhyNot(result, e)));
  }
  const DisplayUnit unit = OutputUnit(result.log.machine);
  text += fmt::format(
      "\nmodel error on strokes left out {} {}, sensor noise alone would cause {} {}\n"
      "{}, {} of {} rows used\n",
      ShortNumber(result.fit.rms_holdout * unit.factor), unit.name,
      ShortNumber(result.fit.noise_floor * unit.factor), unit.name, Counted(result.fit.strokes, "stroke"),
      result.log.totals.used, result.log.totals.samples);
  for (const std::string& note : result.log.notes) text += "Note: " + note + "\n";
  if (result.held_out) text += HeldOutText(*result.held_out, unit);
  for (const AssumedTolerance& assumed : result.assumed) text += AssumedText(assumed) + "\n";
  const ModelHeadline headline = HeadlineOf(result.fit, ErrorFinding::kNoise);
  if (headline.standing == ModelStanding::kNotJudged) text += headline.text + "\n";
  return text + SuspicionText(result.suspicion);
}

nlohmann::json ParametersJson(const std::vector<Estimate>& parameters) {
  nlohmann::json out = nlohmann::json::object();
  for (const Estimate& e : parameters)
    out[e.parameter] = {{"value", e.value},
                        {"std", e.std},
                        {"unit", e.unit},
                        {"interval95", {e.value - kNormal95 * e.std, e.value + kNormal95 * e.std}},
                        {"excitation", e.excitation},
                        {"identifiable", e.reason == EstimateReason::kUpdated},
                        {"reason", ReasonName(e.reason)}};
  return out;
}

void AddConfoundings(const std::vector<Confounding>& confounded, nlohmann::json& parameters) {
  for (const Confounding& c : confounded) {
    if (!parameters.contains(c.parameter)) continue;
    nlohmann::json& parameter = parameters[c.parameter];
    parameter["confounded_with"] = c.effects;
    parameter["confounded_bias"] = c.bias;
    parameter["why"] = c.reason.english;
    parameter["advice"] = c.advice.english;
  }
}

nlohmann::json AssumedJson(const std::vector<AssumedTolerance>& assumed) {
  nlohmann::json out = nlohmann::json::array();
  for (const AssumedTolerance& tolerance : assumed)
    out.push_back({{"name", tolerance.name}, {"std", tolerance.std}});
  return out;
}

nlohmann::json FitJson(const FitResult& result) {
  const DisplayUnit unit = OutputUnit(result.log.machine);
  nlohmann::json parameters = ParametersJson(result.fit.parameters);
  if (!result.trust.rate.fast_enough)
    for (auto& parameter : parameters) {
      parameter["identifiable"] = false;
      parameter["reason"] = "sampled_too_slowly";
    }
  AddConfoundings(result.confounded, parameters);
  nlohmann::json out = {
      {"parameters", parameters},
      {"strokes", result.fit.strokes},
      {"samples", result.log.totals.used},
      {"rows", result.log.totals.samples},
      {"rms_holdout", result.fit.rms_holdout * unit.factor},
      {"noise_floor", result.fit.noise_floor * unit.factor},
      {"unit", unit.name},
      {"model_version", result.log.machine.model_version},
      {"effects", result.log.machine.added_effects},
      {"assumed_tolerances", AssumedJson(result.assumed)},
      {"held_out", result.held_out ? HeldOutJson(*result.held_out, unit) : nlohmann::json()},
      {"notes", result.log.notes},
      {"warnings", Warnings(result)}};
  AddSuspicion(result.suspicion, out);
  return out;
}

}  // namespace hydroscope
