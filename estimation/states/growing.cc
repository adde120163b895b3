#include "estimation/states/growing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/contains.h"
#include "estimation/column_products.h"
#include "estimation/decompositions.h"
#include "estimation/states/white_noise.h"

namespace hydroscope {
namespace {

constexpr int kOutputsThatGrow = 3;

/// Normal equations of free runs over the first rows of all episodes: parameters, then free initial states by episode.
struct HorizonSums {
  double cost = std::numeric_limits<double>::infinity();  ///< half the sum of squares
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

class GrowingFit {
 public:
  GrowingFit(const shooting::Task& task, const Eigen::VectorXd& start, const StateFitOptions& options)
      : task_(task),
        options_(options),
        simulator_(task.model),
        segments_(shooting::WholeEpisodes(task.episodes)),
        free_(shooting::FreeStates(*task.model, {0, 0, 0, false})) {
    for (std::size_t p = 0; p < task.scale.size(); ++p) point_.q.push_back(task.scale.ToScaled(p, start[p]));
    shooting::GuessSegments(task, segments_, point_);
  }

  /// From a point near the minimum, on all rows.
  GrowingFit(const shooting::Task& task, const shooting::Point& near, const StateFitOptions& options)
      : task_(task),
        options_(options),
        simulator_(task.model),
        segments_(shooting::WholeEpisodes(task.episodes)),
        free_(shooting::FreeStates(*task.model, {0, 0, 0, false})),
        point_(near) {}

  /// Whether runs over all rows err hardly more, by the reading, than over the first `rows`.
  bool StaysOnItsWay(int rows) {
    const Eigen::VectorXd cost = Foreseen(Longest());
    return cost[cost.size() - 1] * rows <=
           growth_.on_its_way * cost[rows - 1] * static_cast<double>(cost.size());
  }

  bool Polish(shooting::Point& point) {
    point_.valid = Minimise(Longest(), options_.iterations, options_.tolerance);
    if (point_.valid && SeekFlatParameters()) Minimise(Longest(), options_.iterations, options_.tolerance);
    point = point_;
    return point.valid;
  }

  /// Over the first `rows` rows, then more and more of them. Not valid where the model diverges.
  shooting::Point Run(int rows) {
    const int longest = Longest();
    shooting::Point before = point_;
    rows = std::min(rows, longest);
    int reached = rows;
    double least = std::numeric_limits<double>::infinity(), growth = growth_.most;
    while (true) {
      const bool last = rows >= longest;
      const int iterations = last ? options_.iterations : options_.start_iterations;
      const double tolerance = last ? options_.start_tolerance : growth_.tolerance;
      bool fine = Minimise(rows, iterations, tolerance);
      if (fine && BeginsBetterAsGuessed(rows)) fine = Minimise(rows, iterations, tolerance);
      if (!fine) point_.cost = std::numeric_limits<double>::infinity();
      const double cost = point_.cost / rows;
      if (!(cost < growth_.astray * least) && growth > growth_.least && rows > reached) {
        growth = std::sqrt(growth);
        point_ = before;
      } else {
        if (!std::isfinite(point_.cost)) return {};
        if (last) break;
        before = point_;
        least = cost;
        reached = rows;
        growth = std::min(growth * growth, growth_.most);
      }
      const auto grown = [&] {
        const int longer = std::max(reached + 1, static_cast<int>(growth * reached));
        return longer > longest - reached / growth_.rest ? longest : longer;
      };
      rows = grown();
      const Eigen::VectorXd foreseen = Foreseen(rows);
      while (!(foreseen[rows - 1] < growth_.hopeless * least * rows) && growth > growth_.least &&
             rows > reached + 1) {
        growth = std::sqrt(growth);
        rows = grown();
      }
    }
    point_.valid = true;
    return point_;
  }

 private:
  int Longest() const {
    int longest = 0;
    for (const Episode& e : task_.episodes) longest = std::max(longest, e.rows());
    return longest;
  }
  int parameters() const { return static_cast<int>(point_.q.size()); }
  int unknowns() const { return parameters() + static_cast<int>(free_.size() * segments_.size()); }

  /// The cost up to each row, were the runs to go on as they are.
  Eigen::VectorXd Foreseen(int rows) {
    const StateModel& model = *task_.model;
    task_.Set(shooting::Unscaled(task_, point_.q), simulator_);
    Eigen::VectorXd cost = Eigen::VectorXd::Zero(rows);
    for (std::size_t e = 0; e < task_.episodes.size(); ++e) {
      const Episode& episode = task_.episodes[e];
      const int last = std::min(rows, episode.rows()) - 1;
      simulator_.Run(episode, 0, last, simulator_.Initial(episode, Given(point_, e)), nullptr, run_);
      for (int row = 0; row <= last; ++row)
        for (int j = 0; j < model.output.rows; ++j) {
          const double error =
              (run_.outputs(row, j) - episode.signal(row, model.outputs[j])) / task_.noise[j];
          if (std::isfinite(error)) cost[row] += 0.5 * error * error;
        }
      if (run_.diverged) cost[std::min(run_.rows, last)] = std::numeric_limits<double>::infinity();
    }
    for (int row = 1; row < rows; ++row) cost[row] += cost[row - 1];
    return cost;
  }

  /// States that an episode begins with, as far as they are free.
  Eigen::VectorXd Given(const shooting::Point& point, std::size_t episode) const {
    return Eigen::Map<const Eigen::VectorXd>(point.z[episode].data(), task_.state_scale.size())
        .cwiseProduct(task_.state_scale);
  }

  /// What the file says a run begins near was said with other parameters: with these it is taken if it costs less.
  bool BeginsBetterAsGuessed(int rows) {
    if (!Contains(task_.model->near, true)) return false;
    shooting::Point guessed = point_;
    shooting::GuessSegments(task_, segments_, guessed);
    guessed.cost = Evaluate(guessed, rows).cost;
    if (!(guessed.cost < point_.cost)) return false;
    point_ = std::move(guessed);
    return true;
  }

  /// A parameter that hardly matters where it stands stays there in a fit, though elsewhere it may matter: each of them is put where
  /// in its range runs cost least. False: nowhere less.
  bool SeekFlatParameters() {
    const HorizonSums here = Evaluate(point_, Longest());
    double least = here.cost;
    for (int p = 0; p < parameters(); ++p) {
      const auto i = static_cast<std::size_t>(p);
      const double low = task_.scale.low(i), span = task_.scale.high(i) - low;
      if (!task_.scale.ranged(i) || !(0.5 * here.hessian(p, p) * span * span < growth_.flat * here.cost))
        continue;
      double best = point_.q[i];
      for (int k = 0; k <= growth_.parts_of_flat; ++k) {
        point_.q[i] = low + span * k / growth_.parts_of_flat;
        const double cost = Foreseen(Longest())[Longest() - 1];
        if (!(cost < least)) continue;
        least = cost;
        best = point_.q[i];
      }
      point_.q[i] = best;
    }
    return least < here.cost;
  }

  /// False if the model diverges at the point it begins at.
  bool Minimise(int rows, int iterations, double tolerance) {
    const bool sees_much = SeesMuch(*task_.model);
    const double no_matter = sees_much ? damping_.no_matter : 0;
    HorizonSums here = Evaluate(point_, rows);
    if (!std::isfinite(here.cost)) return false;
    const double largest = here.hessian.diagonal().head(parameters()).maxCoeff();
    double damping = (sees_much ? damping_.first : damping_.first_of_few) * largest;
    bool refused = false;  // the last step: one as little damped as before would be refused again
    for (int k = 0; k < iterations && damping < damping_.most * here.hessian.diagonal().maxCoeff();) {
      const auto next = Stepped(here, damping, damping / largest);
      if (!next) {
        damping *= damping_.more;
        continue;
      }
      ++k;
      HorizonSums there = Evaluate(*next, rows);
      const double small = std::max(no_matter, tolerance * here.cost);
      if (!(there.cost < here.cost)) {
        if (std::isfinite(there.cost) && there.cost - here.cost < small) break;
        damping *= damping_.more * damping_.more;
        refused = true;
        continue;
      }
      const double gain = here.cost - there.cost;
      point_ = *next;
      here = std::move(there);
      if (!refused) damping = std::max(damping * damping_.less, damping_.least * largest);
      refused = false;
      if (gain < small) break;
    }
    point_.cost = here.cost;
    return true;
  }

  /// The damped step, within the ranges; nothing if it is too long to be trusted. Initial states are damped by `share` of their own
  /// curvature: where their step alone is too long, no damping of the parameters would make it one that helps.
  std::optional<shooting::Point> Stepped(const HorizonSums& at, double damping, double share) const {
    const int n = parameters();
    Eigen::MatrixXd matrix = at.hessian;
    Eigen::VectorXd gradient = at.gradient;
    for (int i = 0; i < unknowns(); ++i)
      matrix(i, i) +=
          i < n ? damping : std::max(damping_.least_of_states, share) * matrix(i, i) + damping_.of_none;
    for (int p = 0; p < n; ++p) {  // what would leave its range stays
      const auto i = static_cast<std::size_t>(p);
      if (!((point_.q[i] <= task_.scale.low(i) && gradient[p] > 0) ||
            (point_.q[i] >= task_.scale.high(i) && gradient[p] < 0)))
        continue;
      matrix.row(p).setZero();
      matrix.col(p).setZero();
      matrix(p, p) = 1;
      gradient[p] = 0;
    }
    const Eigen::VectorXd step = -SymmetricFactor(matrix).Solve(gradient);
    if (!step.allFinite() || (n > 0 && step.head(n).cwiseAbs().maxCoeff() > damping_.longest))
      return std::nullopt;
    shooting::Point next = point_;
    for (int p = 0; p < n; ++p) {
      const auto i = static_cast<std::size_t>(p);
      next.q[i] = std::clamp(next.q[i] + step[p], task_.scale.low(i), task_.scale.high(i));
    }
    int column = n;
    for (auto& z : next.z)
      for (const int i : free_) z[i] += step[column++];
    return next;
  }

  HorizonSums Evaluate(const shooting::Point& point, int rows) {
    const StateModel& model = *task_.model;
    const int n = parameters(), states = model.states(), outputs = model.output.rows,
              free = static_cast<int>(free_.size());
    HorizonSums sum{0, Eigen::MatrixXd::Zero(unknowns(), unknowns()), Eigen::VectorXd::Zero(unknowns())};
    task_.Set(shooting::Unscaled(task_, point.q), simulator_);
    Eigen::VectorXd factor(n + free);
    for (int p = 0; p < n; ++p) factor[p] = task_.scale.Slope(static_cast<std::size_t>(p), point.q[p]);
    factor.tail(free).setOnes();
    for (std::size_t e = 0; e < task_.episodes.size(); ++e) {
      const Episode& episode = task_.episodes[e];
      RowMatrix by_parameter;
      const Eigen::VectorXd x0 = simulator_.Initial(episode, Given(point, e), &by_parameter);
      RowMatrix start = RowMatrix::Zero(states, n + free);
      start.leftCols(by_parameter.cols()) = by_parameter;
      for (int k = 0; k < free; ++k) start(free_[k], n + k) = task_.state_scale[free_[k]];
      const int last = std::min(rows, episode.rows()) - 1;
      simulator_.Run(episode, 0, last, x0, &start, run_);
      if (run_.diverged) return {};
      error_.resize((last + 1) * outputs);
      for (int row = 0; row <= last; ++row)
        for (int j = 0; j < outputs; ++j) {
          const double measured = episode.signal(row, model.outputs[j]);
          const bool good = std::isfinite(run_.outputs(row, j) - measured);
          const int at = row * outputs + j;
          error_[at] = good ? (run_.outputs(row, j) - measured) / task_.noise[j] : 0.0;
          run_.slopes.row(at) *= good ? 1 / task_.noise[j] : 0.0;
        }
      sum.cost += 0.5 * error_.squaredNorm();
      const Eigen::MatrixXd square = factor.asDiagonal() * ColumnProducts(run_.slopes) * factor.asDiagonal();
      const Eigen::VectorXd slope = factor.cwiseProduct(run_.slopes.transpose() * error_);
      const int at = n + static_cast<int>(e) * free;
      sum.hessian.topLeftCorner(n, n) += square.topLeftCorner(n, n);
      sum.hessian.block(at, at, free, free) += square.bottomRightCorner(free, free);
      sum.hessian.block(0, at, n, free) += square.topRightCorner(n, free);
      sum.hessian.block(at, 0, free, n) += square.bottomLeftCorner(free, n);
      sum.gradient.head(n) += slope.head(n);
      sum.gradient.segment(at, free) += slope.tail(free);
    }
    if (!std::isfinite(sum.cost) || !sum.hessian.allFinite()) return {};
    return sum;
  }

  const shooting::Task& task_;
  const StateFitOptions& options_;
  const HorizonGrowth& growth_ = options_.growth;
  const StepDamping& damping_ = options_.damping;
  StateSimulator simulator_;
  std::vector<shooting::Segment> segments_;
  std::vector<int> free_;
  shooting::Point point_;
  StateRun run_;
  Eigen::VectorXd error_;
};

}  // namespace

bool SeesMuch(const StateModel& model) { return model.output.rows >= kOutputsThatGrow; }

bool GrowsHorizon(const StateModel& model) {
  return (SeesMuch(model) || Contains(model.near, true)) && model.parameter_count() > 0;
}

Eigen::VectorXd WhiteNoise(const StateModel& model, std::span<const Episode> episodes,
                           const Eigen::VectorXd& largest) {
  Eigen::VectorXd noise = largest;
  for (int j = 0; j < noise.size(); ++j) {
    WhiteNoiseVariance white;
    for (const Episode& e : episodes) white.Add(e.signal.col(model.outputs[j]), e.mean_rows);
    if (white.Value() > 0) noise[j] = std::min(noise[j], std::sqrt(white.Value()));
  }
  return noise;
}

shooting::Point FitGrowing(const shooting::Task& task, const Eigen::VectorXd& start,
                           const StateFitOptions& options) {
  int mean_rows = 1;
  for (const Episode& e : task.episodes) mean_rows = std::max(mean_rows, e.mean_rows);
  return GrowingFit(task, start, options).Run(options.growth.first_rows * mean_rows);
}

shooting::Point GrowFrom(const shooting::Task& task, const shooting::Point& few, int rows,
                         const StateFitOptions& options) {
  GrowingFit fit(task, few, options);
  return fit.StaysOnItsWay(rows) ? few : fit.Run(rows);
}

bool PolishWhole(const shooting::Task& task, const StateFitOptions& options, shooting::Point& point) {
  return GrowingFit(task, point, options).Polish(point);
}

}  // namespace hydroscope
