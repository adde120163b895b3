#include "workbench/states/states_location.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "diagnosis/states/state_residuals.h"
#include "workbench/explain/located_output.h"

namespace hydroscope {
namespace {

DisplayUnit UnitOf(const StateModel& model, int output) {
  const int signal = model.outputs[static_cast<std::size_t>(output)];
  const auto unit = FindUnit(model.machine.signals[static_cast<std::size_t>(signal)].unit);
  return DisplayUnitFor(unit ? unit->si : "1");
}

/// Error energy beside noise, over that of noise.
double Standing(const OutputErrors& errors) {
  for (const StrokeResiduals& piece : errors.residuals.strokes)
    if (!piece.noise_variance.empty())
      return errors.location.excess / std::max(piece.noise_variance.front(), 1e-300);
  return 0;
}

/// SI unit of a state or input; "1" where the file states none.
std::string UnitInSi(const Machine& machine, const std::string& name) {
  std::string unit;
  for (const StateSpec& state : machine.states.states)
    if (state.name == name) unit = state.unit;
  for (const SignalSpec& signal : machine.signals)
    if (signal.name == name) unit = signal.unit;
  const auto known = FindUnit(unit);
  return known ? std::string(known->si) : "1";
}

nlohmann::json Of(const OutputErrors& errors, nlohmann::json json) {
  json["output"] = errors.output;
  json["error_unit"] = errors.unit.name;
  return json;
}

}  // namespace

std::vector<OutputErrors> LocateErrors(const StateFit& fit, std::span<const Episode> episodes,
                                       const StateRemainder& left) {
  LocateOptions options = StateLocateOptions();
  if (!left.structured) options.floor_excess = std::numeric_limits<double>::infinity();
  std::vector<OutputErrors> out;
  for (int j = 0; j < fit.model->output.rows; ++j) {
    OutputErrors errors{fit.model->machine.states.outputs[static_cast<std::size_t>(j)].signal,
                        UnitOf(*fit.model, j),
                        ResidualsOf(fit, episodes, j, left),
                        {}};
    errors.location = Locate(errors.residuals, options);
    out.push_back(std::move(errors));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const OutputErrors& a, const OutputErrors& b) { return Standing(a) > Standing(b); });
  return out;
}

ShownLaw Shown(const MissingLaw& law, const StateModel& model) {
  const std::string output = UnitInSi(model.machine, law.equation);
  const std::string variable = UnitInSi(model.machine, law.variable);
  const DisplayUnit unit = DisplayUnitFor(variable);
  ShownLaw out;
  out.equation = law.equation;
  out.unit = EffectUnitFor(law.of_state ? output + "/s" : output);
  if (law.of_state && output == "1") out.unit = {1, "1/s"};
  out.shape = {law.variable, std::string(unit.name), law.share, {}};
  for (const MissingLaw::Point& point : law.points)
    out.shape.points.push_back({point.x * unit.factor + unit.offset, point.value, point.std});
  return out;
}

std::string LocatedText(const std::vector<OutputErrors>& errors) {
  std::string text;
  for (const OutputErrors& of : errors)
    text += LocatedText(of.location.located, of.unit, errors.size() > 1 ? of.output : "");
  return text;
}

nlohmann::json LocatedJson(const std::vector<OutputErrors>& errors) {
  nlohmann::json out = nlohmann::json::array();
  for (const OutputErrors& of : errors)
    for (nlohmann::json& located : LocatedJson(of.location.located, of.unit.factor))
      out.push_back(Of(of, std::move(located)));
  return out;
}

nlohmann::json MapsJson(const std::vector<OutputErrors>& errors) {
  nlohmann::json out = nlohmann::json::array();
  if (errors.empty()) return out;
  const OutputErrors& of = errors.front();
  for (nlohmann::json& map : MapsJson(of.location, of.residuals.signals, of.unit.factor))
    out.push_back(Of(of, std::move(map)));
  return out;
}

}  // namespace hydroscope
