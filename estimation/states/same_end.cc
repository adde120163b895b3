#include "estimation/states/same_end.h"

#include <cmath>

#include "estimation/states/fit_task.h"

namespace hydroscope {

bool IsWhereItEnded(const StateFit& fit, std::span<const Episode> episodes, const StateStart& start,
                    double same_minimum) {
  if (!shooting::SameEnd(shooting::ParameterScale(*fit.model), fit.parameters, start.parameters))
    return false;
  StateSimulator simulator(fit.model);
  simulator.SetParameters(start.parameters);
  StateRun run;
  double here = 0, there = 0;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const Episode& episode = episodes[e];
    simulator.Run(episode, 0, episode.rows() - 1, simulator.Initial(episode, start.initial[e]), nullptr, run);
    if (run.diverged) return false;
    for (int j = 0; j < fit.model->output.rows; ++j) {
      const double weight = 1 / (fit.noise[j] * fit.noise[j]);
      const auto& ended = fit.residuals[e].col(j);
      for (Eigen::Index row = 0; row < ended.size(); ++row) {
        const double error = episode.signal(row, fit.model->outputs[j]) - run.outputs(row, j);
        if (!std::isfinite(error) || !std::isfinite(ended[row])) continue;
        here += weight * error * error;
        there += weight * ended[row] * ended[row];
      }
    }
  }
  return std::abs(here - there) <= same_minimum * there;
}

}  // namespace hydroscope
