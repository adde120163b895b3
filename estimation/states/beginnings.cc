#include "estimation/states/beginnings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/decompositions.h"
#include "estimation/states/fit_task.h"

namespace hydroscope::shooting {
namespace {

constexpr double kMoreThanNoise = 2;  ///< energy of the error in the first rows, in noise variances a reading
constexpr double kReading = 0.05;     ///< standard deviation of a reading, of the output's variation
constexpr double kClose = 1;          ///< square of the error over it, per reading, that is close enough
constexpr int kFewest = 8;            ///< rows that are looked at first, then twice as many ...
constexpr int kSteps = 6;             ///< ... of Gauss and Newton each
constexpr double kFirstDamping = 1e-3, kLessDamping = 0.1, kMoreDamping = 10, kLargestDamping = 1e4;

/// Of one segment after the other.
class BeginningSearch {
 public:
  BeginningSearch(const Task& task, const Point& point)
      : task_(task), simulator_(task.model), reading_(kReading * OutputScale(*task.model, task.episodes)) {
    simulator_.KnowParameters();
    task.Set(Unscaled(task, point.q), simulator_);
  }

  /// Scaled states at the beginning of a segment, from a guess.
  std::vector<double> From(const Segment& segment, const std::vector<double>& guess, int rows) {
    free_ = FreeStates(*task_.model, segment);
    const int longest = std::min(rows, segment.last - segment.first + 1);
    if (free_.empty() || longest < 2) return guess;
    Eigen::VectorXd at(static_cast<Eigen::Index>(free_.size()));
    for (Eigen::Index k = 0; k < at.size(); ++k) at[k] = guess[State(k)];
    const Eigen::VectorXd prior = at;
    if (Evaluate(segment, guess, at, prior, longest).cost <= kClose * Readings(longest)) return guess;
    const int fewest = std::min(kFewest * task_.episodes[EpisodeOf(segment)].mean_rows, longest);
    for (int horizon = fewest;; horizon = std::min(2 * horizon, longest)) {
      Minimise(segment, guess, prior, horizon, at);
      if (horizon == longest) break;
    }
    std::vector<double> found = guess;
    for (Eigen::Index k = 0; k < at.size(); ++k) found[State(k)] = at[k];
    return found;
  }

 private:
  /// Half the squares, and their normal equations.
  struct Sums {
    double cost = std::numeric_limits<double>::infinity();
    Eigen::MatrixXd hessian;
    Eigen::VectorXd gradient;
  };

  static std::size_t EpisodeOf(const Segment& segment) { return static_cast<std::size_t>(segment.episode); }
  std::size_t State(Eigen::Index k) const { return static_cast<std::size_t>(free_[k]); }
  double Readings(int rows) const { return 0.5 * rows * task_.model->output.rows; }

  void Minimise(const Segment& segment, const std::vector<double>& guess, const Eigen::VectorXd& prior,
                int rows, Eigen::VectorXd& at) {
    Sums here = Evaluate(segment, guess, at, prior, rows);
    double damping = kFirstDamping;
    for (int step = 0; step < kSteps && std::isfinite(here.cost) && damping < kLargestDamping; ++step) {
      Eigen::MatrixXd damped = here.hessian;
      damped.diagonal() *= 1 + damping;
      Eigen::VectorXd next = at - SymmetricFactor(damped).Solve(here.gradient);
      for (Eigen::Index k = 0; k < next.size(); ++k) next[k] = Within(next[k], free_[k]);
      Sums there = Evaluate(segment, guess, next, prior, rows);
      if (!(there.cost < here.cost)) {
        damping *= kMoreDamping;
        continue;
      }
      at = std::move(next);
      here = std::move(there);
      damping *= kLessDamping;
    }
  }

  double Within(double scaled, int state) const {
    const double low = simulator_.limits()[state] / task_.state_scale[state],
                 high = simulator_.limits()[task_.model->states() + state] / task_.state_scale[state];
    return std::clamp(scaled, low, std::max(low, high));
  }

  Sums Evaluate(const Segment& segment, const std::vector<double>& guess, const Eigen::VectorXd& at,
                const Eigen::VectorXd& prior, int rows) {
    const StateModel& model = *task_.model;
    const Episode& episode = task_.episodes[EpisodeOf(segment)];
    const Eigen::Index states = model.states(), outputs = model.output.rows, free = at.size();
    Eigen::VectorXd x0(states);
    for (Eigen::Index i = 0; i < states; ++i) x0[i] = guess[i] * task_.state_scale[i];
    for (Eigen::Index k = 0; k < free; ++k) x0[free_[k]] = at[k] * task_.state_scale[free_[k]];
    if (segment.first == 0) x0 = simulator_.Initial(episode, x0);
    RowMatrix start = RowMatrix::Zero(states, free);
    for (Eigen::Index k = 0; k < free; ++k) start(free_[k], k) = task_.state_scale[free_[k]];
    if (task_.GivenUp()) return {};
    const Segment first_rows{segment.episode, segment.first, segment.first + rows - 1, false};
    task_.Run(episode, first_rows, x0, &start, simulator_, run_);
    if (run_.diverged) return {};
    Sums sums{0.5 * (at - prior).squaredNorm(), Eigen::MatrixXd::Identity(free, free), at - prior};
    for (Eigen::Index row = 0; row < rows; ++row)
      for (Eigen::Index j = 0; j < outputs; ++j) {
        const double error = run_.outputs(row, j) - episode.signal(segment.first + row, model.outputs[j]);
        if (!std::isfinite(error)) continue;
        const Eigen::VectorXd slope = run_.slopes.row(row * outputs + j) / reading_[j];
        sums.cost += 0.5 * error * error / (reading_[j] * reading_[j]);
        sums.hessian += slope * slope.transpose();
        sums.gradient += slope * (error / reading_[j]);
      }
    return std::isfinite(sums.cost) && sums.hessian.allFinite() ? sums : Sums{};
  }

  const Task& task_;
  StateSimulator simulator_;
  Eigen::VectorXd reading_;
  std::vector<int> free_;
  StateRun run_;
};

}  // namespace

void SeekBeginnings(const Task& task, const std::vector<Segment>& segments, int rows, Point& point) {
  BeginningSearch search(task, point);
  for (std::size_t s = 0; s < segments.size(); ++s) point.z[s] = search.From(segments[s], point.z[s], rows);
}

std::vector<double> BeginningOf(const Task& of_all, const Episode& episode, const Eigen::VectorXd& parameters,
                                const StateFitOptions& options) {
  Task task = of_all;
  task.episodes = {&episode, 1};
  const Segment whole = WholeEpisodes(task.episodes).front();
  const auto followed = [&](Point point) {
    point.valid = false;
    for (const int rows : {options.segment_rows, options.growth.first_rows}) {
      Segment begin = whole;
      begin.last = std::min(whole.last, rows - 1);
      Point from = point;
      if (Minimise(task, {begin},
                   {.iterations = options.start_iterations, .tolerance = options.start_tolerance}, true,
                   from))
        point = std::move(from);
    }
    return point;
  };
  Point guess = PointAt(task, parameters);
  GuessSegments(task, {whole}, guess);
  Point best = followed(guess);
  const int readings = std::min(episode.rows(), options.growth.first_rows) * task.model->output.rows;
  if (best.valid && 2 * best.cost <= kMoreThanNoise * readings) return best.z.front();
  StateRun run;
  Trial(task, parameters, episode, run);
  for (const double share : {0.25, 0.5, 0.75}) {
    const int row = static_cast<int>(share * whole.last);
    if (row >= run.rows) break;
    Point later = guess;
    for (const int i : FreeStates(*task.model, whole))
      if (task.model->measured_by[i] < 0) later.z.front()[i] = run.states(row, i) / task.state_scale[i];
    later = followed(std::move(later));
    if (later.valid && (!best.valid || later.cost < best.cost)) best = std::move(later);
  }
  return best.z.front();
}

}  // namespace hydroscope::shooting
