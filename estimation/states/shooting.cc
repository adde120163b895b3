#include "estimation/states/shooting.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <optional>

namespace hydroscope::shooting {

std::vector<int> FreeStates(const StateModel& model, const Segment& segment) {
  std::vector<int> free;
  for (int i = 0; i < model.states(); ++i)
    if (segment.first > 0 || model.estimated[i]) free.push_back(i);
  return free;
}

namespace {

/// Errors of one segment over the noise, and of its joint to the next one. Blocks: parameters, free initial states, states
/// at the start of the next segment.
class SegmentCost : public ceres::CostFunction {
 public:
  SegmentCost(const Task& task, const Segment& segment)
      : task_(task), segment_(segment), free_(FreeStates(*task.model, segment)), simulator_(task.model) {
    rows_ = segment.last - segment.first + (segment.joined ? 0 : 1);
    outputs_ = task.model->output.rows;
    set_num_residuals(rows_ * outputs_ + (segment.joined ? task.model->states() : 0));
    if (task.scale.size() > 0)
      mutable_parameter_block_sizes()->push_back(static_cast<int>(task.scale.size()));
    if (!free_.empty()) mutable_parameter_block_sizes()->push_back(static_cast<int>(free_.size()));
    if (segment.joined) mutable_parameter_block_sizes()->push_back(task.model->states());
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const StateModel& model = *task_.model;
    const int states = model.states(), parameters = static_cast<int>(task_.scale.size());
    std::size_t block = 0;
    Eigen::VectorXd theta(parameters);
    const double* q = parameters > 0 ? blocks[block++] : nullptr;
    for (int p = 0; p < parameters; ++p) theta[p] = task_.scale.FromScaled(static_cast<std::size_t>(p), q[p]);
    task_.Set(theta, simulator_);
    const double* z = free_.empty() ? nullptr : blocks[block++];
    Eigen::VectorXd given = Eigen::VectorXd::Zero(states);
    for (std::size_t k = 0; k < free_.size(); ++k) given[free_[k]] = z[k] * task_.state_scale[free_[k]];
    const Episode& episode = task_.episodes[segment_.episode];
    RowMatrix by_parameter = RowMatrix::Zero(states, model.parameter_count());
    const Eigen::VectorXd x0 = segment_.first > 0 ? given : simulator_.Initial(episode, given, &by_parameter);
    const bool want = jacobians != nullptr;
    if (task_.GivenUp()) return false;
    // The line search looks at a step with slopes, then the fit without them, and with them again once it is taken.
    const bool known = IsKnown(q, z);
    if (want && !known) {
      KnowFromNowOn(q, z);
      SlopesAtStart(by_parameter);
      task_.Run(episode, segment_, x0, &start_slopes_, simulator_, run_);
    } else if (!known) {
      task_.Run(episode, segment_, x0, nullptr, simulator_, plain_);
    }
    const StateRun& run = want || known ? run_ : plain_;
    if (run.diverged) return false;
    Fill(episode, run, residuals);
    const double* next = segment_.joined ? blocks[block] : nullptr;
    double* joint = residuals + rows_ * outputs_;
    for (int i = 0; next != nullptr && i < states; ++i)
      joint[i] = (next[i] - run.end[i] / task_.state_scale[i]) / task_.joint;
    if (want) FillJacobians(episode, q, jacobians);
    return true;
  }

 private:
  /// Whether the last run with slopes was of this point.
  bool IsKnown(const double* q, const double* z) const {
    return known_ &&
           std::equal(known_->begin(), known_->begin() + static_cast<std::ptrdiff_t>(task_.scale.size()),
                      q) &&
           (z == nullptr ||
            std::equal(z, z + free_.size(), known_->end() - static_cast<std::ptrdiff_t>(free_.size())));
  }
  void KnowFromNowOn(const double* q, const double* z) const {
    known_.emplace(q, q + task_.scale.size());
    if (z != nullptr) known_->insert(known_->end(), z, z + free_.size());
  }
  void SlopesAtStart(const RowMatrix& by_parameter) const {
    const auto parameters = static_cast<int>(task_.scale.size());
    start_slopes_ = RowMatrix::Zero(task_.model->states(), parameters + static_cast<int>(free_.size()));
    start_slopes_.leftCols(by_parameter.cols()) = by_parameter;
    for (std::size_t k = 0; k < free_.size(); ++k)
      start_slopes_(free_[k], parameters + static_cast<int>(k)) = task_.state_scale[free_[k]];
  }
  void Fill(const Episode& episode, const StateRun& run, double* residuals) const {
    for (int row = 0; row < rows_; ++row)
      for (int j = 0; j < outputs_; ++j) {
        const double measured = episode.signal(segment_.first + row, task_.model->outputs[j]);
        const double error = run.outputs(row, j) - measured;
        residuals[row * outputs_ + j] = std::isfinite(error) ? error / task_.noise[j] : 0.0;
      }
  }
  void FillJacobians(const Episode& episode, const double* q, double** jacobians) const {
    const StateModel& model = *task_.model;
    const int states = model.states(), parameters = static_cast<int>(task_.scale.size()),
              free = static_cast<int>(free_.size());
    std::size_t block = 0;
    const auto fill = [&](double* out, int from, int count, const auto& factor) {
      Eigen::Map<RowMatrix> to(out, num_residuals(), count);
      to.setZero();
      for (int row = 0; row < rows_; ++row)
        for (int j = 0; j < outputs_; ++j) {
          const int r = row * outputs_ + j;
          if (!std::isfinite(run_.outputs(row, j) - episode.signal(segment_.first + row, model.outputs[j])))
            continue;
          for (int c = 0; c < count; ++c) to(r, c) = run_.slopes(r, from + c) * factor(c) / task_.noise[j];
        }
      if (!segment_.joined) return;
      for (int i = 0; i < states; ++i)
        for (int c = 0; c < count; ++c)
          to(rows_ * outputs_ + i, c) =
              -run_.end_slopes(i, from + c) * factor(c) / (task_.state_scale[i] * task_.joint);
    };
    if (parameters > 0) {
      if (jacobians[block] != nullptr)
        fill(jacobians[block], 0, parameters,
             [&](int c) { return task_.scale.Slope(static_cast<std::size_t>(c), q[c]); });
      ++block;
    }
    if (free > 0) {
      if (jacobians[block] != nullptr) fill(jacobians[block], parameters, free, [](int) { return 1.0; });
      ++block;
    }
    if (segment_.joined && jacobians[block] != nullptr) {
      Eigen::Map<RowMatrix> to(jacobians[block], num_residuals(), states);
      to.setZero();
      for (int i = 0; i < states; ++i) to(rows_ * outputs_ + i, i) = 1 / task_.joint;
    }
  }

  const Task& task_;
  Segment segment_;
  std::vector<int> free_;
  int rows_ = 0, outputs_ = 0;
  mutable StateSimulator simulator_;
  mutable StateRun run_, plain_;  ///< with slopes, and without
  mutable RowMatrix start_slopes_;
  mutable std::optional<std::vector<double>> known_;  ///< parameters and free initial states of run_
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

bool Minimise(const Task& task, const std::vector<Segment>& segments, int iterations, double tolerance,
              bool fixed, Point& point) {
  static const bool quiet [[maybe_unused]] = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;  // a step that diverges is no news: it is taken back
    return true;
  }();
  ceres::Problem problem;
  const auto parameters = static_cast<int>(point.q.size());
  std::vector<std::vector<double>> free(segments.size());
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const int i : FreeStates(*task.model, segments[s])) free[s].push_back(point.z[s][i]);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    std::vector<double*> blocks;
    if (parameters > 0) blocks.push_back(point.q.data());
    if (!free[s].empty()) blocks.push_back(free[s].data());
    if (segments[s].joined) blocks.push_back(free[s + 1].data());
    if (blocks.empty()) {  // nothing is free: a run of a known model
      point.valid = true;
      return true;
    }
    problem.AddResidualBlock(new SegmentCost(task, segments[s]), nullptr, blocks);
  }
  if (parameters > 0) {
    for (int p = 0; p < parameters; ++p) {
      const auto at = static_cast<std::size_t>(p);
      if (std::isfinite(task.scale.low(at)))
        problem.SetParameterLowerBound(point.q.data(), p, task.scale.low(at));
      if (std::isfinite(task.scale.high(at)))
        problem.SetParameterUpperBound(point.q.data(), p, task.scale.high(at));
    }
    if (fixed) problem.SetParameterBlockConstant(point.q.data());
  }
  StateSimulator simulator(task.model);
  task.Set(Unscaled(task, point.q), simulator);
  const int states = task.model->states();
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const std::vector<int> which = FreeStates(*task.model, segments[s]);
    for (std::size_t k = 0; k < which.size(); ++k) {
      const double low = simulator.limits()[which[k]] / task.state_scale[which[k]],
                   high = simulator.limits()[states + which[k]] / task.state_scale[which[k]];
      const auto index = static_cast<int>(k);
      free[s][k] = std::clamp(free[s][k], low, std::max(low, high));
      if (std::isfinite(low)) problem.SetParameterLowerBound(free[s].data(), index, low);
      if (std::isfinite(high) && high > low) problem.SetParameterUpperBound(free[s].data(), index, high);
    }
  }
  ceres::Solver::Options options;
  options.max_num_iterations = iterations;
  options.linear_solver_type = segments.size() > 4 ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = tolerance;
  options.parameter_tolerance = 1e-3 * tolerance;
  options.num_threads = 1;
  // Line searches stay cubic, though each trial then costs sensitivities: with quadratic ones `benchmark pump` ends in a wrong
  // minimum of the outlet pressure.
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  point.valid = summary.termination_type != ceres::FAILURE;
  point.converged = summary.termination_type == ceres::CONVERGENCE;
  point.cost = summary.final_cost;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const std::vector<int> which = FreeStates(*task.model, segments[s]);
    for (std::size_t k = 0; k < which.size(); ++k) point.z[s][which[k]] = free[s][k];
  }
  return point.valid;
}

}  // namespace hydroscope::shooting
