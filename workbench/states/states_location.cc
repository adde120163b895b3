#include "workbench/states/states_location.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "diagnosis/states/state_residuals.h"
#include "models/output_unit.h"
#include "workbench/explain/located_output.h"

namespace hydroscope {
namespace {

nlohmann::json WithOutput(const OutputErrors& errors, nlohmann::json json) {
  json["output"] = errors.output;
  json["error_unit"] = errors.unit.name;
  return json;
}

}  // namespace

std::vector<OutputErrors> LocateErrors(const StateFit& fit, std::span<const Episode> episodes,
                                       const StateRemainder& left) {
  LocateOptions options;
  options.overlap = 1;  // readings share no noise
  if (!left.structured) options.floor_excess = std::numeric_limits<double>::infinity();
  std::vector<int> worst_first(static_cast<std::size_t>(fit.model->output.rows));
  std::iota(worst_first.begin(), worst_first.end(), 0);
  std::ranges::stable_sort(
      worst_first, [&](int a, int b) { return fit.noise[a] / fit.scale[a] > fit.noise[b] / fit.scale[b]; });
  const Machine& machine = fit.model->machine;
  std::vector<OutputErrors> out;
  for (const int j : worst_first) {
    const std::string& name = machine.states.outputs[j].signal;
    out.push_back({name, DisplayUnitFor(SiOf(machine, name)), ResidualsOf(fit, episodes, j, left), {}});
    out.back().location = Locate(out.back().residuals, options);
  }
  return out;
}

ShownLaw Shown(const MissingLaw& law, const StateModel& model) {
  const std::string output(SiOf(model.machine, law.equation));
  const DisplayUnit unit = DisplayUnitFor(SiOf(model.machine, law.variable));
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
      out.push_back(WithOutput(of, std::move(located)));
  return out;
}

nlohmann::json MapsJson(const std::vector<OutputErrors>& errors) {
  nlohmann::json out = nlohmann::json::array();
  if (errors.empty()) return out;
  const OutputErrors& of = errors.front();
  for (nlohmann::json& map : MapsJson(of.location, of.residuals.signals, of.unit.factor))
    out.push_back(WithOutput(of, std::move(map)));
  return out;
}

}  // namespace hydroscope
