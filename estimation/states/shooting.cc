#include "estimation/states/shooting.h"

#include <algorithm>

#include "estimation/column_products.h"

namespace hydroscope::shooting {

std::vector<int> FreeStates(const StateModel& model, const Segment& segment) {
  std::vector<int> free;
  for (int i = 0; i < model.states(); ++i)
    if (segment.first > 0 || model.estimated[i]) free.push_back(i);
  return free;
}

namespace {

/// Errors of one segment over the noise, and of its joint to the next one. Unknowns: parameters, free initial states, states
/// at the start of the next segment.
class SegmentErrors {
 public:
  /// `own`, `next`: place of the segment's free initial states among all unknowns, and of the next segment's.
  SegmentErrors(const Task& task, const Segment& segment, int own, int next)
      : task_(task), segment_(segment), free_(FreeStates(*task.model, segment)), simulator_(task.model) {
    rows_ = segment.last - segment.first + (segment.joined ? 0 : 1);
    for (int p = 0; p < parameters(); ++p) places_.push_back(p);
    for (int k = 0; k < static_cast<int>(free_.size()); ++k) places_.push_back(own + k);
    for (int i = 0; segment.joined && i < task.model->states(); ++i) places_.push_back(next + i);
  }

  /// Half the sum of squares; infinite where the model diverges.
  double Cost(const Eigen::VectorXd& at) {
    return Run(at, false) ? 0.5 * Errors(at).squaredNorm() : kInfinity;
  }

  /// Adds what the segment says of the unknowns to `gradient`, and the products of its columns to `entries`.
  double Add(const Eigen::VectorXd& at, Eigen::VectorXd& gradient,
             std::vector<Eigen::Triplet<double>>& entries) {
    if (!Run(at, true)) return kInfinity;
    const Eigen::VectorXd errors = Errors(at);
    const RowMatrix slopes = Slopes(at);
    const Eigen::VectorXd own = slopes.transpose() * errors;
    const Eigen::MatrixXd products = ColumnProducts(slopes);
    for (Eigen::Index a = 0; a < own.size(); ++a) {
      gradient[places_[static_cast<std::size_t>(a)]] += own[a];
      for (Eigen::Index b = 0; b < own.size(); ++b)
        entries.emplace_back(places_[static_cast<std::size_t>(a)], places_[static_cast<std::size_t>(b)],
                             products(a, b));
    }
    return 0.5 * errors.squaredNorm();
  }

 private:
  int parameters() const { return static_cast<int>(task_.scale.size()); }
  int outputs() const { return task_.model->output.rows; }
  int joints() const { return segment_.joined ? task_.model->states() : 0; }

  bool Run(const Eigen::VectorXd& at, bool with_slopes) {
    if (task_.GivenUp()) return false;
    const int states = task_.model->states(), n = parameters();
    Eigen::VectorXd theta(n), given = Eigen::VectorXd::Zero(states);
    for (int p = 0; p < n; ++p) theta[p] = task_.scale.FromScaled(static_cast<std::size_t>(p), at[p]);
    for (std::size_t k = 0; k < free_.size(); ++k)
      given[free_[k]] = at[places_[static_cast<std::size_t>(n) + k]] * task_.state_scale[free_[k]];
    task_.Set(theta, simulator_);
    const Episode& episode = task_.episodes[segment_.episode];
    RowMatrix by_parameter = RowMatrix::Zero(states, task_.model->parameter_count());
    const Eigen::VectorXd x0 = segment_.first > 0 ? given : simulator_.Initial(episode, given, &by_parameter);
    RowMatrix start;
    if (with_slopes) {
      start = RowMatrix::Zero(states, n + static_cast<int>(free_.size()));
      start.leftCols(by_parameter.cols()) = by_parameter;
      for (std::size_t k = 0; k < free_.size(); ++k)
        start(free_[k], n + static_cast<int>(k)) = task_.state_scale[free_[k]];
    }
    task_.Run(episode, segment_, x0, with_slopes ? &start : nullptr, simulator_, run_);
    return !run_.diverged;
  }

  bool IsMeasured(int row, int output) const {
    const double measured =
        task_.episodes[segment_.episode].signal(segment_.first + row, task_.model->outputs[output]);
    return std::isfinite(run_.outputs(row, output) - measured);
  }

  Eigen::VectorXd Errors(const Eigen::VectorXd& at) const {
    Eigen::VectorXd errors = Eigen::VectorXd::Zero(rows_ * outputs() + joints());
    const Episode& episode = task_.episodes[segment_.episode];
    for (int row = 0; row < rows_; ++row)
      for (int j = 0; j < outputs(); ++j)
        if (IsMeasured(row, j))
          errors[row * outputs() + j] =
              (run_.outputs(row, j) - episode.signal(segment_.first + row, task_.model->outputs[j])) /
              task_.noise[j];
    for (int i = 0; i < joints(); ++i)
      errors[rows_ * outputs() + i] = (at[places_[places_.size() - static_cast<std::size_t>(joints() - i)]] -
                                       run_.end[i] / task_.state_scale[i]) /
                                      task_.joint;
    return errors;
  }

  RowMatrix Slopes(const Eigen::VectorXd& at) const {
    const int n = parameters(), moved = n + static_cast<int>(free_.size());
    Eigen::VectorXd factor = Eigen::VectorXd::Ones(moved);
    for (int p = 0; p < n; ++p) factor[p] = task_.scale.Slope(static_cast<std::size_t>(p), at[p]);
    RowMatrix slopes = RowMatrix::Zero(rows_ * outputs() + joints(), moved + joints());
    for (int row = 0; row < rows_; ++row)
      for (int j = 0; j < outputs(); ++j)
        if (IsMeasured(row, j)) {
          const int r = row * outputs() + j;
          slopes.row(r).head(moved) = run_.slopes.row(r).cwiseProduct(factor.transpose()) / task_.noise[j];
        }
    for (int i = 0; i < joints(); ++i) {
      const int r = rows_ * outputs() + i;
      slopes.row(r).head(moved) =
          run_.end_slopes.row(i).cwiseProduct(factor.transpose()) / (-task_.state_scale[i] * task_.joint);
      slopes(r, moved + i) = 1 / task_.joint;
    }
    return slopes;
  }

  const Task& task_;
  Segment segment_;
  std::vector<int> free_;
  std::vector<int> places_;  ///< of the columns of the slopes among all unknowns
  int rows_ = 0;
  StateSimulator simulator_;
  StateRun run_;
};

/// What the machine file, the data and limits say of the states at a row; `run`: a run there, nullptr if it diverged.
Eigen::VectorXd GuessedStates(const Task& task, const Episode& episode, int row, const StateRun* run,
                              const StateSimulator& simulator) {
  const int states = task.model->states();
  const Eigen::VectorXd& limits = simulator.limits();
  const Eigen::VectorXd near = row == 0 ? simulator.Near(episode) : Eigen::VectorXd::Constant(states, NAN);
  Eigen::VectorXd x(states);
  for (int i = 0; i < states; ++i) {
    const int output = task.model->measured_by[i];
    const double measured = output < 0 ? NAN : episode.Reading(row, task.model->outputs[output]);
    const double low = limits[i], high = limits[states + i];
    if (std::isfinite(near[i]))
      x[i] = near[i];
    else if (std::isfinite(measured))
      x[i] = measured;
    else if (run != nullptr && row < run->rows)
      x[i] = run->states(row, i);
    else if (std::isfinite(low) && std::isfinite(high))
      x[i] = 0.5 * (low + high);
    else
      x[i] = 0;
    x[i] = std::clamp(x[i], low, std::max(low, high));
  }
  return x;
}

}  // namespace

std::vector<Segment> WholeEpisodes(std::span<const Episode> episodes) {
  std::vector<Segment> segments;
  for (std::size_t e = 0; e < episodes.size(); ++e)
    segments.push_back({static_cast<int>(e), 0, episodes[e].rows() - 1, false});
  return segments;
}

std::vector<Segment> ShortSegments(std::span<const Episode> episodes, int rows) {
  std::vector<Segment> segments;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const int last = episodes[e].rows() - 1;
    for (int first = 0; first < last || first == 0; first += rows) {
      const int end = last - first < 2 * rows ? last : first + rows;
      segments.push_back({static_cast<int>(e), first, end, end < last});
      if (end == last) break;
    }
  }
  return segments;
}

std::vector<double> Scaled(const Eigen::VectorXd& x, const Eigen::VectorXd& scale) {
  std::vector<double> z;
  for (Eigen::Index i = 0; i < x.size(); ++i) z.push_back(x[i] / scale[i]);
  return z;
}

Eigen::VectorXd Unscaled(const Task& task, const std::vector<double>& q) {
  Eigen::VectorXd theta(static_cast<Eigen::Index>(q.size()));
  for (std::size_t p = 0; p < q.size(); ++p) theta[p] = task.scale.FromScaled(p, q[p]);
  return theta;
}

void Trial(const Task& task, const Eigen::VectorXd& theta, const Episode& episode, StateRun& run) {
  StateSimulator simulator(task.model);
  simulator.SetParameters(theta);
  const Eigen::VectorXd guess = GuessedStates(task, episode, 0, nullptr, simulator);
  simulator.Run(episode, 0, episode.rows() - 1, simulator.Initial(episode, guess), nullptr, run);
}

void GuessSegments(const Task& task, const std::vector<Segment>& segments, Point& point) {
  const Eigen::VectorXd theta = Unscaled(task, point.q);
  StateSimulator simulator(task.model);
  simulator.SetParameters(theta);
  StateRun run;
  int tried = -1;
  point.z.clear();
  for (const Segment& segment : segments) {
    const Episode& episode = task.episodes[segment.episode];
    if (segment.episode != tried) Trial(task, theta, episode, run);
    tried = segment.episode;
    point.z.push_back(Scaled(GuessedStates(task, episode, segment.first, &run, simulator), task.state_scale));
  }
}

bool Minimise(const Task& task, const std::vector<Segment>& segments, const DescentOptions& how, bool fixed,
              Point& point) {
  const auto parameters = static_cast<int>(point.q.size());
  const int states = task.model->states();
  std::vector<int> begins;  // place of each segment's free initial states
  int unknowns = parameters;
  for (const Segment& segment : segments) {
    begins.push_back(unknowns);
    unknowns += static_cast<int>(FreeStates(*task.model, segment).size());
  }
  if (unknowns == 0) {  // nothing is free: a run of a known model
    point.valid = true;
    return true;
  }
  std::vector<SegmentErrors> errors;
  for (std::size_t s = 0; s < segments.size(); ++s)
    errors.emplace_back(task, segments[s], begins[s], segments[s].joined ? begins[s + 1] : 0);

  BoundedSquares squares;
  Eigen::VectorXd at(unknowns);
  squares.low = Eigen::VectorXd::Constant(unknowns, -kInfinity);
  squares.high = Eigen::VectorXd::Constant(unknowns, kInfinity);
  for (int p = 0; p < parameters; ++p) {
    const auto i = static_cast<std::size_t>(p);
    at[p] = point.q[i];
    squares.low[p] = fixed ? at[p] : task.scale.low(i);
    squares.high[p] = fixed ? at[p] : task.scale.high(i);
  }
  StateSimulator simulator(task.model);
  task.Set(Unscaled(task, point.q), simulator);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    int place = begins[s];
    for (const int i : FreeStates(*task.model, segments[s])) {
      at[place] = point.z[s][static_cast<std::size_t>(i)];
      squares.low[place] = simulator.limits()[i] / task.state_scale[i];
      squares.high[place] =
          std::max(squares.low[place], simulator.limits()[states + i] / task.state_scale[i]);
      ++place;
    }
  }
  squares.cost = [&](const Eigen::VectorXd& here) {
    double cost = 0;
    for (SegmentErrors& segment : errors)
      if (std::isfinite(cost)) cost += segment.Cost(here);
    return cost;
  };
  std::vector<Eigen::Triplet<double>> entries;
  squares.sum = [&](const Eigen::VectorXd& here) {
    SquaresSum sum{0, Eigen::VectorXd::Zero(unknowns), {unknowns, unknowns}};
    entries.clear();
    for (SegmentErrors& segment : errors) sum.cost += segment.Add(here, sum.gradient, entries);
    sum.products.setFromTriplets(entries.begin(), entries.end());
    return sum;
  };
  const Descent descent = hydroscope::Minimise(squares, how, at);
  point.valid = descent.begun && !task.GivenUp();
  point.converged = descent.converged;
  point.cost = descent.cost;
  for (int p = 0; p < parameters; ++p) point.q[static_cast<std::size_t>(p)] = at[p];
  for (std::size_t s = 0; s < segments.size(); ++s) {
    int place = begins[s];
    for (const int i : FreeStates(*task.model, segments[s]))
      point.z[s][static_cast<std::size_t>(i)] = at[place++];
  }
  return point.valid;
}

}  // namespace hydroscope::shooting
