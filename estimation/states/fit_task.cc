#include "estimation/states/fit_task.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace hydroscope::shooting {

Point PointAt(const Task& task, const Eigen::VectorXd& parameters) {
  Point point;
  for (std::size_t p = 0; p < task.scale.size(); ++p)
    point.q.push_back(task.scale.ToScaled(p, parameters[p]));
  return point;
}

std::vector<Episode> FirstRows(std::span<const Episode> episodes, int rows) {
  std::vector<Episode> out;
  for (const Episode& e : episodes) {
    if (rows <= 1) break;
    const int take = std::min(rows, e.rows());
    out.push_back(e.Part(0, take));
    rows -= take;
  }
  return out;
}

Eigen::VectorXd OutputScale(const StateModel& model, std::span<const Episode> episodes) {
  Eigen::VectorXd scale(model.output.rows);
  for (int j = 0; j < model.output.rows; ++j) {
    double count = 0, sum = 0, squares = 0;
    for (const Episode& e : episodes)
      for (int row = 0; row < e.rows(); ++row) {
        const double y = e.signal(row, model.outputs[j]);
        if (!std::isfinite(y)) continue;
        const double step = y - sum / std::max(count, 1.0);
        count += 1;
        sum += y;
        squares += step * (y - sum / count);
      }
    scale[j] = std::max(std::sqrt(squares / std::max(count, 1.0)), 1e-300);
  }
  return scale;
}

namespace {

/// Largest size of each state, from data, limits and a run of the model.
Eigen::VectorXd StateScale(const Task& task, const Eigen::VectorXd& theta) {
  const int states = task.model->states();
  StateSimulator simulator(task.model);
  simulator.SetParameters(theta);
  StateRun run;
  Trial(task, theta, task.episodes.front(), run);
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(states);
  for (int i = 0; i < states; ++i) {
    const int output = task.model->measured_by[i];
    double largest = 0;
    if (output >= 0) {
      for (const Episode& e : task.episodes)
        for (int row = 0; row < e.rows(); ++row) {
          const double y = e.signal(row, task.model->outputs[output]);
          if (std::isfinite(y)) largest = std::max(largest, std::abs(y));
        }
    } else if (!run.diverged) {
      largest = run.states.col(i).cwiseAbs().maxCoeff();
    }
    for (const int limit : {i, states + i})
      if (largest == 0 && std::isfinite(simulator.limits()[limit]))
        largest = std::abs(simulator.limits()[limit]);
    if (largest > 0 && std::isfinite(largest)) scale[i] = largest;
  }
  return scale;
}

}  // namespace

Task TaskOf(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes) {
  constexpr double kFirstNoise = 0.05;  // of an output's variation; found anew once there is a fit
  Task task{model, episodes, ParameterScale(*model), {}, {}, 0, false, nullptr};
  task.noise = kFirstNoise * OutputScale(*model, episodes);
  Eigen::VectorXd start(model->parameter_count());
  for (int p = 0; p < start.size(); ++p) start[p] = model->parameters[p].spec.start;
  task.state_scale = StateScale(task, start);
  return task;
}

std::vector<Eigen::VectorXd> StartsOf(const Task& task, const StateFitOptions& options, bool near) {
  const auto count = static_cast<Eigen::Index>(task.scale.size());
  Eigen::VectorXd first(count);
  for (Eigen::Index p = 0; p < count; ++p) first[p] = task.model->parameters[p].spec.start;
  std::vector<Eigen::VectorXd> starts = {first};
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform;
  for (int k = 0; k < options.starts && count > 0; ++k) {
    Eigen::VectorXd drawn = first;
    for (Eigen::Index p = 0; p < count; ++p) {
      const auto at = static_cast<std::size_t>(p);
      const double share = uniform(random), reach = near ? (k + 1.0) / options.starts : 1.0;
      if (!task.scale.ranged(at)) continue;
      const double anywhere = task.scale.low(at) + share * (task.scale.high(at) - task.scale.low(at));
      drawn[p] =
          task.scale.FromScaled(at, reach * anywhere + (1 - reach) * task.scale.ToScaled(at, first[p]));
    }
    starts.push_back(std::move(drawn));
  }
  return starts;
}

namespace {

/// Share of its range by which that parameter differs which differs most; nothing where none has a range.
std::optional<double> Apart(const ParameterScale& scale, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  std::optional<double> largest;
  for (std::size_t p = 0; p < scale.size(); ++p) {
    if (!scale.ranged(p)) continue;
    const auto at = static_cast<Eigen::Index>(p);
    const double apart = std::abs(scale.ToScaled(p, a[at]) - scale.ToScaled(p, b[at])),
                 range = scale.high(p) - scale.low(p);
    largest = std::max(largest.value_or(0), range > 0 ? apart / range : 0);
  }
  return largest;
}

}  // namespace

bool FarApart(const ParameterScale& scale, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  constexpr double kFar = 0.25;
  return Apart(scale, a, b).value_or(kFar) >= kFar;
}

bool SameEnd(const ParameterScale& scale, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  constexpr double kElsewhere = 0.1;
  return Apart(scale, a, b).value_or(0) < kElsewhere;
}

namespace {

/// Whether a run stopped for steps that had become too short: no state had run away, and rates were numbers from the beginning.
bool StoppedInPlace(const Task& task, const StateRun& run) {
  constexpr double kFurther = 2;  // times what states had been before, or their sizes: no flight yet
  const auto states = run.states.topRows(run.rows);
  if (run.rows <= 1 && run.end.transpose() == states.row(0)) return false;
  const Eigen::VectorXd before =
      states.cwiseAbs().colwise().maxCoeff().transpose().cwiseMax(task.state_scale);
  return (run.end.array().abs() <= kFurther * before.array()).all();
}

}  // namespace

Told DivergedText(const Task& task, const Eigen::VectorXd& theta) {
  for (const Episode& episode : task.episodes) {
    StateRun run;
    Trial(task, theta, episode, run);
    if (!run.diverged) continue;
    if (StoppedInPlace(task, run))
      return Tell(
          "the model cannot be followed: from the starting values of the machine file steps become too short {:.4g} s after the "
          "episode's beginning. Rates may jump to and fro there, as sign(v) of a dry friction that holds what rests (write "
          "tanh(v/v_0) in its place, v_0 a small speed), a root or a quotient may end (limit it with max(..., 0)), or something "
          "moves far faster than rows show (narrow the ranges in [parameters])",
          "dem Modell lässt sich nicht folgen: von den Startwerten der Maschinendatei aus werden die Schritte {:.4g} s nach "
          "Beginn der Episode zu kurz. Dort springen vielleicht Änderungsraten hin und her, wie sign(v) einer trockenen Reibung, "
          "die hält, was ruht (tanh(v/v_0) an ihrer Stelle schreiben, v_0 eine kleine Geschwindigkeit), eine Wurzel oder ein "
          "Quotient endet (mit max(..., 0) begrenzen), oder etwas bewegt sich weit schneller, als Zeilen zeigen (die Bereiche in "
          "[parameters] enger fassen)",
          episode.time[run.rows - 1] - episode.time.front());
    if (run.rows <= 1)
      return {
          "the model cannot be run from the starting values of the machine file: its rates are not finite at the "
          "first row of an episode (a division by zero, a root of something negative) or grow without bound before the "
          "second; limit them with max(..., 0), or check start and initial",
          "das Modell lässt sich von den Startwerten der Maschinendatei aus nicht rechnen: seine Änderungsraten sind "
          "in der "
          "ersten Zeile einer Episode nicht endlich (Division durch null, Wurzel aus Negativem) oder wachsen vor der "
          "zweiten "
          "ohne Grenze; sie mit max(..., 0) begrenzen, oder start und initial prüfen"};
    Eigen::Index worst = 0;
    run.states.row(run.rows - 1).cwiseAbs().cwiseQuotient(task.state_scale.transpose()).maxCoeff(&worst);
    return Tell(
        "the model diverges: from the starting values of the machine file {} runs away {:.4g} s after the "
        "episode's beginning; narrow the ranges in [parameters] or check the signs of its equations",
        "das Modell läuft davon: von den Startwerten der Maschinendatei aus wächst {} ab {:.4g} s nach Beginn der "
        "Episode "
        "ohne Grenze; die Bereiche in [parameters] enger fassen, oder die Vorzeichen der Gleichungen prüfen",
        task.model->machine.states.states[worst].name, episode.time[run.rows - 1] - episode.time.front());
  }
  return {
      "the model diverges from every start; narrow the ranges in [parameters] or check the signs of its equations",
      "das Modell läuft von jedem Start aus davon; die Bereiche in [parameters] enger fassen, oder die Vorzeichen der "
      "Gleichungen prüfen"};
}

}  // namespace hydroscope::shooting
