#include "pipeline/doubtful_estimates.h"

#include "estimation/closed_loop/loop_episodes.h"
#include "estimation/closed_loop/reversal.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "pipeline/log_faults/usual_modulus.h"

namespace hydroscope {

Told ReversedIn(const Machine& machine, std::span<const Estimate> parameters) {
  const ClosedLoopPlant* const loop = ClosedLoopOf(machine);
  if (loop == nullptr || parameters.size() != loop->parameters.size()) return {};
  std::vector<double> values;
  for (const Estimate& estimate : parameters) values.push_back(estimate.value);
  return ReversedSignal(*loop, values, ReferencesOf(machine));
}

std::vector<Told> DoubtsOf(const Machine& machine, std::span<const Estimate> parameters) {
  std::vector<Told> doubts = UnusualParameters(KindOf(machine), parameters);
  if (Told reversed = ReversedIn(machine, parameters); !reversed.empty())
    doubts.push_back(std::move(reversed));
  return doubts;
}

}  // namespace hydroscope
