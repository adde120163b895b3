#include "diagnosis/states/other_causes/missing_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "estimation/states/fit_task.h"
#include "estimation/states/white_noise.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

/// Readings of an output and what the model gives beside them, both with their sign turned for lower ends.
struct Course {
  std::vector<double> read, modelled;  ///< NaN where nothing was read
  double noise = 0;
};

Course CourseToEnds(const StateFit& fit, std::span<const Episode> episodes, int output, double sign) {
  Course out;
  WhiteNoiseVariance white;
  const int signal = fit.model->outputs[static_cast<std::size_t>(output)];
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    Eigen::VectorXd readings(episodes[e].rows());
    for (int row = 0; row < episodes[e].rows(); ++row) {
      readings[row] = episodes[e].Reading(row, signal);
      out.read.push_back(sign * readings[row]);
      out.modelled.push_back(sign * fit.runs[e].outputs(row, output));
    }
    white.Add(readings, 1);
  }
  out.noise = white.count() > 0 ? std::sqrt(std::max(0.0, white.Value())) : 0;
  return out;
}

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Where readings stand while the model goes beyond all of them.
std::optional<MissingLimit> FlatEnd(const Course& course, const MissingLimitOptions& options) {
  double top = -INFINITY;
  for (const double y : course.read)
    if (std::isfinite(y)) top = std::max(top, y);
  if (!std::isfinite(top) || course.noise <= 0) return std::nullopt;
  std::vector<double> there;
  std::size_t beyond = 0;
  for (std::size_t k = 0; k < course.read.size(); ++k) {
    if (!(course.modelled[k] > top + options.beyond * course.noise)) continue;
    ++beyond;
    if (std::isfinite(course.read[k])) there.push_back(course.read[k]);
  }
  MissingLimit out;
  out.share = static_cast<double>(beyond) / static_cast<double>(std::max<std::size_t>(1, course.read.size()));
  if (out.share < options.least_share) return std::nullopt;
  // Where the sensor ends, readings are left out (pipeline/log_faults/sensor_ends.h); what is left ends just before.
  out.at = top;
  if (2 * there.size() < beyond) return out;
  out.at = MedianOf(there);
  const auto flat = std::count_if(there.begin(), there.end(), [&](double y) {
    return std::abs(y - out.at) <= options.flat * course.noise;
  });
  if (static_cast<double>(flat) < options.least_flat * static_cast<double>(there.size())) return std::nullopt;
  return out;
}

/// The state that an output reads as it is, if it has no limit on that side.
std::string StateBehind(const Machine& machine, const OutputSpec& output, bool upper) {
  for (const StateSpec& state : machine.states.states)
    if (state.name == output.expression && (upper ? state.max : state.min).empty()) return state.name;
  return {};
}

/// Error over that of `fit` with the limit; 1 if nothing can be fitted then.
double ErrorWith(const MissingLimit& limit, const StateFit& fit, std::span<const Episode> episodes) {
  const auto model = BuildStateModel(WithLimit(fit.model->machine, limit), fit.model->effects);
  if (!model) return 1;
  const StateFit with = FitStates(*model, episodes, BestAlone());
  if (!with.solved()) return 1;
  return std::sqrt(with.noise.cwiseQuotient(fit.noise).squaredNorm() / static_cast<double>(fit.noise.size()));
}

}  // namespace

std::optional<MissingLimit> FindMissingLimit(const StateFit& fit, std::span<const Episode> episodes,
                                             const MissingLimitOptions& options) {
  const std::vector<Episode> few = shooting::FirstRows(episodes, options.rows);
  const StateFit without = FollowStates(fit.model, few, fit.parameters, fit.noise);
  if (!without.solved()) return std::nullopt;
  const Machine& machine = fit.model->machine;
  MissingLimit found;
  for (int j = 0; j < fit.model->output.rows; ++j)
    for (const bool upper : {true, false}) {
      auto limit = FlatEnd(CourseToEnds(without, few, j, upper ? 1 : -1), options);
      if (!limit) continue;
      const OutputSpec& output = machine.states.outputs[static_cast<std::size_t>(j)];
      limit->signal = output.signal;
      limit->upper = upper;
      if (!upper) limit->at = -limit->at;
      for (const std::string& state : {StateBehind(machine, output, upper), std::string()}) {
        limit->state = state;
        limit->error = ErrorWith(*limit, without, few);
        if (limit->error < found.error) found = *limit;
      }
    }
  if (found.error > options.less_error) return std::nullopt;
  return found;
}

Machine WithLimit(Machine machine, const MissingLimit& limit) {
  const std::string at = fmt::format("{:.17g}", limit.at);
  for (StateSpec& state : machine.states.states)
    if (state.name == limit.state) (limit.upper ? state.max : state.min) = at;
  if (!limit.state.empty()) return machine;
  for (OutputSpec& output : machine.states.outputs)
    if (output.signal == limit.signal)
      output.expression = fmt::format("{}({}, {})", limit.upper ? "min" : "max", output.expression, at);
  return machine;
}

Told MissingLimitText(const MissingLimit& limit, const Machine& machine, bool taken) {
  const DisplayUnit unit = ShownUnit(machine, limit.signal);
  const double at = limit.at * unit.factor + unit.offset;
  const Told remedy =
      limit.state.empty()
          ? Tell("write \"{}(..., {:.4g})\" (SI) for it in [outputs] if its sensor ends there",
                 "wenn sein Sensor dort endet, in [outputs] dafür \"{}(..., {:.4g})\" (SI) schreiben",
                 limit.upper ? "min" : "max", limit.at)
          : Tell("write {} = {:.4g} for {} in [states] if it stops there",
                 "wenn {2} dort aufhört, in [states] {0} = {1:.4g} dafür schreiben",
                 limit.upper ? "max" : "min", at, limit.state);
  return Tell(
      "{} stays at {:.4g} {} where the model goes on (in {:.0f} % of the rows); with that limit the error is {:.2g} % of this{}: {}",
      "{} bleibt bei {:.4g} {}, wo das Modell weitergeht (in {:.0f} % der Zeilen); mit dieser Grenze beträgt der Fehler {:.2g} % "
      "von diesem{}: {}",
      limit.signal, at, std::string(unit.name), 100 * limit.share, 100 * limit.error,
      taken ? Wording(", and what is told is of the machine with it",
                      ", und was gesagt wird, gilt der Maschine mit ihr")
            : Wording("", ""),
      remedy);
}

}  // namespace hydroscope
