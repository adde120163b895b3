#include "estimation/linear_form/starts.h"

#include <algorithm>

namespace hydroscope {
namespace {

/// Value of a machine's parameter; nothing if the form has it neither itself nor as its reciprocal.
std::optional<double> ValueIn(const LinearFit& fit, const std::string& name) {
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    const double value = fit.value[k];
    if (fit.parameters[k] == name) return value;
    if (fit.parameters[k] == "1/" + name && value != 0) return 1 / value;
  }
  return std::nullopt;
}

}  // namespace

LinearStart StartOf(const Machine& machine, std::span<const Episode> episodes) {
  LinearStart start{machine, {}, std::nullopt};
  const LinearForm form = LinearFormOf(machine);
  if (form.equations.empty()) return start;
  start.fit = FitLinearForm(form, machine, episodes);
  if (!start.fit->solved()) return start;
  for (ParameterSpec& p : start.machine.states.parameters)
    if (const auto value = ValueIn(*start.fit, p.name)) p.start = std::clamp(*value, p.min, p.max);
  start.options.starts = 0;
  return start;
}

}  // namespace hydroscope
