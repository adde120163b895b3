#include "estimation/states/unseen_ripple.h"

#include <algorithm>
#include <array>

namespace hydroscope {

bool OnlyRippleShows(const StateModel& model, const UnseenDirection& unseen) {
  if (model.ripples.empty() || unseen.parts.size() != 1) return false;
  const auto parameter =
      std::ranges::find(model.parameters, unseen.parts.front().first, &StateParameter::name);
  if (parameter == model.parameters.end()) return false;
  const auto column = model.states() + static_cast<int>(parameter - model.parameters.begin());
  // Without ripple no equation has a slope by the parameter, wherever the states and inputs stand: at `all` of their units.
  const auto depends = [&](const Equations& equations, double all) {
    std::vector<double> registers = equations.slopes.Registers();
    const auto ripples = registers.begin() + model.states() + model.driving() -
                         static_cast<std::ptrdiff_t>(model.ripples.size());
    const auto parameters = ripples + static_cast<std::ptrdiff_t>(model.ripples.size());
    std::fill(registers.begin(), ripples, all);
    std::fill(ripples, parameters, 0.0);
    std::ranges::transform(model.parameters, parameters,
                           [](const StateParameter& p) { return p.spec.start; });
    equations.slopes.RunFixed(registers.data());
    equations.slopes.Run(registers.data());
    for (std::size_t e = 0; e < equations.entries.size(); ++e)
      if (equations.entries[e].column == column &&
          registers[equations.slopes.output(static_cast<std::size_t>(equations.rows) + e)] != 0)
        return true;
    return false;
  };
  return std::ranges::none_of(std::array{1.0, 1e-3, 1e-6}, [&](double all) {
    return depends(model.dynamics, all) || depends(model.output, all);
  });
}

}  // namespace hydroscope
