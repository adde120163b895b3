#include "service/fit_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/constants.h"
#include "core/units.h"
#include "service/effect_units.h"

namespace hydroscope {
namespace {

const char* Meaning(const std::string& parameter) {
  if (parameter == "K") return "effective bulk modulus";
  if (parameter == "V0") return "dead volume";
  if (parameter == "Q_vn") return "nominal valve flow";
  if (parameter == "y_0") return "spool null";
  return "";
}

}  // namespace

std::string FitText(const FitResult& result) {
  std::string text = fmt::format("{:<6} {:>12} {:>26}  {:<6} {}\n", "", "value", "95 % interval", "unit", "");
  for (const Estimate& e : result.fit.parameters) {
    const DisplayUnit unit = DisplayUnitFor(e.unit);
    const auto shown = [&](double si) { return si * unit.factor + unit.offset; };
    const bool trusted = e.reason == EstimateReason::kUpdated;
    text += fmt::format("{:<6} {:>12.5g} {:>12.5g} ... {:<10.5g} {:<6} {}{}\n", e.parameter, shown(e.value),
                        shown(e.value - kNormal95 * e.std), shown(e.value + kNormal95 * e.std),
                        unit.name == "1" ? "-" : unit.name, Meaning(e.parameter),
                        result.too_slow ? "; NOT TO BE TRUSTED: sampled too slowly"
                        : trusted       ? ""
                                        : fmt::format("; NOT IDENTIFIABLE: {}", ReasonText(e.reason)));
  }
  const DisplayUnit unit = OutputUnit(result.log.model.get());
  text += fmt::format(
      "\nmodel error on strokes left out {:.3g} {}, sensor noise alone would cause {:.3g} {}\n"
      "{} strokes, {} of {} rows used\n",
      result.fit.rms_holdout * unit.factor, unit.name, result.fit.noise_floor * unit.factor, unit.name,
      result.fit.strokes, result.log.totals.used, result.log.totals.samples);
  for (const AssumedTolerance& assumed : result.assumed) text += AssumedText(assumed) + "\n";
  return text;
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

nlohmann::json FitJson(const FitResult& result) {
  const DisplayUnit unit = OutputUnit(result.log.model.get());
  nlohmann::json assumed = nlohmann::json::array();
  for (const AssumedTolerance& tolerance : result.assumed)
    assumed.push_back({{"name", tolerance.name}, {"std", tolerance.std}});
  nlohmann::json parameters = ParametersJson(result.fit.parameters);
  if (result.too_slow)
    for (auto& parameter : parameters) {
      parameter["identifiable"] = false;
      parameter["reason"] = "sampled_too_slowly";
    }
  return {{"parameters", parameters},
          {"strokes", result.fit.strokes},
          {"samples", result.log.totals.used},
          {"rows", result.log.totals.samples},
          {"rms_holdout", result.fit.rms_holdout * unit.factor},
          {"noise_floor", result.fit.noise_floor * unit.factor},
          {"unit", unit.name},
          {"assumed_tolerances", assumed}};
}

}  // namespace hydroscope
