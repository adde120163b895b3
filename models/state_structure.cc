#include "models/state_structure.h"

#include <algorithm>

#include "models/machine_kind.h"
#include "models/state_model.h"

namespace hydroscope {

Result<std::shared_ptr<ModelStructure>> BuildStateStructure(const Machine& machine) {
  const auto built = BuildStateModel(machine, machine.added_effects);
  if (!built) return tl::unexpected(built.error());
  const StateModel& states = **built;
  if (states.parameters.empty())
    return BadInput("machine '{}': nothing is identified; name what is in [parameters]", machine.name);
  const Column::Fill nothing = [](const Stretch&, double&, std::span<double> values) {
    std::fill(values.begin(), values.end(), 0.0);
  };
  auto model = std::make_shared<ModelStructure>();
  model->output_unit = std::string(OutputSi(machine));
  model->level_form = true;
  model->base_count = states.parameter_count();
  std::vector<std::string> units;
  for (const StateParameter& p : states.parameters) {
    model->parameters.push_back(p.name);
    model->columns.push_back({p.name, nothing});
    units.push_back(p.spec.unit.empty() ? "1" : p.spec.unit);
  }
  model->columns.push_back({"output", nothing});
  for (std::size_t s = 0; s < machine.signals.size(); ++s) {
    model->channel_names.push_back(machine.signals[s].name);
    model->channel_source.push_back(static_cast<int>(s));
  }
  model->needed_signals = states.inputs;
  model->derive_channels = [](Stretch&) {};
  model->derive = [names = model->parameters, units](const Eigen::VectorXd& theta) {
    std::vector<DerivedParameter> out;
    for (std::size_t p = 0; p < names.size(); ++p) {
      const auto at = static_cast<Eigen::Index>(p);
      out.push_back({names[p], units[p], theta[at], Eigen::VectorXd::Unit(theta.size(), at)});
    }
    return out;
  };
  return model;
}

}  // namespace hydroscope
