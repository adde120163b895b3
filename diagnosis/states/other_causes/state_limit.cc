#include "diagnosis/states/other_causes/state_limit.h"

#include <algorithm>
#include <cmath>

#include "estimation/states/fit_task.h"

namespace hydroscope {
namespace {

/// Share of the rows at which a state stands at a value.
double ShareAt(const StateFit& fit, int state, double limit) {
  Eigen::Index at = 0, rows = 0;
  for (const StateRun& run : fit.runs) {
    const auto apart = (run.states.col(state).array() - limit).abs();
    at += (apart <= 1e-9 * std::max(1.0, std::abs(limit))).count();
    rows += run.states.rows();
  }
  return rows > 0 ? static_cast<double>(at) / static_cast<double>(rows) : 0;
}

/// Error over that of `fit` once a limit is taken out of the machine; 1 if nothing can be fitted then.
double ErrorWithout(int state, bool upper, const StateFit& fit, std::span<const Episode> episodes) {
  Machine machine = fit.model->machine;
  StateSpec& spec = machine.states.states[static_cast<std::size_t>(state)];
  (upper ? spec.max : spec.min).clear();
  const auto model = BuildStateModel(machine, fit.model->effects);
  if (!model) return 1;
  const StateFit without = FitStates(*model, episodes, BestAlone());
  if (!without.solved()) return 1;
  return std::sqrt(without.noise.cwiseQuotient(fit.noise).squaredNorm() /
                   static_cast<double>(fit.noise.size()));
}

}  // namespace

std::optional<DoubtedLimit> FindDoubtedLimit(const StateFit& fit, std::span<const Episode> episodes,
                                             const StateLimitOptions& options) {
  StateSimulator simulator(fit.model);
  simulator.SetParameters(fit.parameters);
  if (!simulator.limits().array().isFinite().any()) return std::nullopt;
  const std::vector<Episode> few = shooting::FirstRows(episodes, options.rows);
  const StateFit with = FollowStates(fit.model, few, fit.parameters, fit.noise);
  if (!with.solved()) return std::nullopt;
  DoubtedLimit found;
  for (int state = 0; state < fit.model->states(); ++state)
    for (const bool upper : {false, true}) {
      const double at = simulator.limits()[state + (upper ? fit.model->states() : 0)];
      if (!std::isfinite(at)) continue;
      const double share = ShareAt(with, state, at);
      if (share < options.least_share) continue;
      const double error = ErrorWithout(state, upper, with, few);
      if (error < found.error)
        found = {fit.model->machine.states.states[static_cast<std::size_t>(state)].name, upper, at, share,
                 error};
    }
  if (found.error > options.less_error) return std::nullopt;
  return found;
}

Told DoubtedLimitText(const DoubtedLimit& limit) {
  return Tell(
      "{0} stands at its limit {1} = {2:.4g} (SI) in {3:.0f} % of the rows, and without that limit the error is {4:.2g} % of this: "
      "if {0} can go further, correct {1} in [states] first; what a wrong limit leaves looks like a law that is missing",
      "{0} steht in {3:.0f} % der Zeilen an seiner Grenze {1} = {2:.4g} (SI), und ohne diese Grenze beträgt der Fehler {4:.2g} % "
      "von diesem: wenn {0} weiter gehen kann, zuerst {1} in [states] berichtigen; was eine falsche Grenze übrig lässt, sieht wie "
      "ein fehlendes Gesetz aus",
      limit.state, limit.upper ? "max" : "min", limit.at, 100 * limit.share, 100 * limit.error);
}

}  // namespace hydroscope
