#include "models/episode_structure.h"

#include <algorithm>

#include "core/told_error.h"
#include "models/machine_kind.h"
#include "models/state_model.h"

namespace hydroscope {
namespace {

/// What is followed from episode to episode.
struct FollowedQuantities {
  std::vector<std::string> names, units;  ///< SI
  std::vector<int> inputs;                ///< signals of the machine without which a row says nothing
};

Result<FollowedQuantities> OfStates(const Machine& machine) {
  const auto built = TRY(BuildStateModel(machine, machine.added_effects));
  const StateModel& states = *built;
  if (states.parameters.empty())
    return BadInput(
        Tell("machine '{}': nothing is identified; name what is in [parameters]",
             "Maschine '{}': nichts wird identifiziert; in [parameters] nennen, was bestimmt werden soll",
             machine.name));
  FollowedQuantities followed{.names = {}, .units = {}, .inputs = states.inputs};
  for (const StateParameter& p : states.parameters) {
    followed.names.push_back(p.name);
    followed.units.push_back(p.spec.unit.empty() ? "1" : p.spec.unit);
  }
  return followed;
}

FollowedQuantities OfClosedLoop(const Machine& machine) {
  const MachineKind& kind = KindOf(machine);
  FollowedQuantities followed;
  for (const LoopParameter& p : kind.closed_loop->parameters) {
    followed.names.emplace_back(p.name);
    followed.units.emplace_back(FindParameter(kind, p.name)->si);
  }
  followed.inputs = SignalsOfLoop(machine);
  return followed;
}

}  // namespace

Result<std::shared_ptr<ModelStructure>> BuildEpisodeStructure(const Machine& machine) {
  const auto followed = TRY(KindOf(machine).has_states ? OfStates(machine) : OfClosedLoop(machine));
  const Column::Fill nothing = [](const Stretch&, double&, std::span<double> values) {
    std::fill(values.begin(), values.end(), 0.0);
  };
  auto model = std::make_shared<ModelStructure>();
  model->output_unit = std::string(OutputSi(machine));
  model->level_form = true;
  model->base_count = static_cast<int>(followed.names.size());
  model->parameters = followed.names;
  for (const std::string& name : followed.names) model->columns.push_back({name, nothing});
  model->columns.push_back({"output", nothing});
  for (std::size_t s = 0; s < machine.signals.size(); ++s) {
    model->channel_names.push_back(machine.signals[s].name);
    model->channel_source.push_back(static_cast<int>(s));
  }
  model->needed_signals = followed.inputs;
  model->derive_channels = [](Stretch&) {};
  model->derive = [names = followed.names, units = followed.units](const Eigen::VectorXd& theta) {
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
