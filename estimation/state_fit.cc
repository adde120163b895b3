#include "estimation/state_fit.h"

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

namespace hydroscope {
namespace {

/// Parameters as the optimiser sees them: ln of those whose range is positive and wide, else over their size.
class ParameterScale {
 public:
  explicit ParameterScale(const StateModel& model) {
    constexpr double kWide = 5;
    for (const StateParameter& p : model.parameters) {
      const ParameterSpec& s = p.spec;
      const bool ranged = std::isfinite(s.min) && std::isfinite(s.max);
      Entry e;
      e.logarithm = s.min > 0 && s.max / s.min >= kWide;
      e.size = std::abs(s.start) > 0 ? std::abs(s.start) : ranged ? 0.5 * (s.max - s.min) : 1.0;
      if (ranged && !e.logarithm) e.size = std::min(e.size, s.max - s.min);
      e.low = e.logarithm ? std::log(s.min) : s.min / e.size;
      e.high = e.logarithm ? std::log(s.max) : s.max / e.size;
      entries_.push_back(e);
    }
  }
  double ToScaled(std::size_t i, double value) const {
    const Entry& e = entries_[i];
    return std::clamp(e.logarithm ? std::log(std::max(value, 1e-300)) : value / e.size, e.low, e.high);
  }
  double FromScaled(std::size_t i, double scaled) const {
    return entries_[i].logarithm ? std::exp(scaled) : scaled * entries_[i].size;
  }
  double Slope(std::size_t i, double scaled) const {
    return entries_[i].logarithm ? std::exp(scaled) : entries_[i].size;
  }
  double low(std::size_t i) const { return entries_[i].low; }
  double high(std::size_t i) const { return entries_[i].high; }
  bool ranged(std::size_t i) const { return std::isfinite(low(i)) && std::isfinite(high(i)); }
  std::size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    bool logarithm = false;
    double size = 1, low = 0, high = 0;
  };
  std::vector<Entry> entries_;
};

/// Rows of an episode that are run in one go.
struct Segment {
  int episode = 0, first = 0, last = 0;  ///< both inclusive
  bool joined = false;                   ///< the next segment goes on where it ends
};

/// What all segments share.
struct FitTask {
  std::shared_ptr<const StateModel> model;
  std::span<const Episode> episodes;
  ParameterScale scale;
  Eigen::VectorXd noise;        ///< per output
  Eigen::VectorXd state_scale;  ///< per state
  double joint = 0;             ///< standard deviation of a joint, in state_scale
};

/// States whose initial value is free in a segment.
std::vector<int> FreeStates(const StateModel& model, const Segment& segment) {
  std::vector<int> free;
  for (int i = 0; i < model.states(); ++i)
    if (segment.first > 0 || model.estimated[static_cast<std::size_t>(i)]) free.push_back(i);
  return free;
}

/// Errors of one segment over the noise, and of its joint to the next one. Blocks: parameters, free initial states, states
/// at the start of the next segment.
class SegmentCost : public ceres::CostFunction {
 public:
  SegmentCost(const FitTask& task, const Segment& segment)
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
    const int states = model.states(), parameters = model.parameter_count();
    std::size_t block = 0;
    Eigen::VectorXd theta(parameters);
    const double* q = parameters > 0 ? blocks[block++] : nullptr;
    for (int p = 0; p < parameters; ++p) theta[p] = task_.scale.FromScaled(static_cast<std::size_t>(p), q[p]);
    simulator_.SetParameters(theta);
    const double* z = free_.empty() ? nullptr : blocks[block++];
    Eigen::VectorXd given = Eigen::VectorXd::Zero(states);
    for (std::size_t k = 0; k < free_.size(); ++k) given[free_[k]] = z[k] * task_.state_scale[free_[k]];
    const Episode& episode = task_.episodes[static_cast<std::size_t>(segment_.episode)];
    RowMatrix by_parameter = RowMatrix::Zero(states, parameters);
    const Eigen::VectorXd x0 = segment_.first > 0 ? given : simulator_.Initial(episode, given, &by_parameter);
    const bool want = jacobians != nullptr;
    if (want) {
      start_slopes_ = RowMatrix::Zero(states, parameters + static_cast<int>(free_.size()));
      start_slopes_.leftCols(parameters) = by_parameter;
      for (std::size_t k = 0; k < free_.size(); ++k)
        start_slopes_(free_[k], parameters + static_cast<int>(k)) = task_.state_scale[free_[k]];
    }
    simulator_.Run(episode, segment_.first, segment_.last, x0, want ? &start_slopes_ : nullptr, run_);
    if (run_.diverged) return false;
    Fill(episode, residuals);
    const double* next = segment_.joined ? blocks[block] : nullptr;
    double* joint = residuals + rows_ * outputs_;
    for (int i = 0; next != nullptr && i < states; ++i)
      joint[i] = (next[i] - run_.end[i] / task_.state_scale[i]) / task_.joint;
    if (want) FillJacobians(episode, q, jacobians);
    return true;
  }

 private:
  void Fill(const Episode& episode, double* residuals) const {
    for (int row = 0; row < rows_; ++row)
      for (int j = 0; j < outputs_; ++j) {
        const double measured =
            episode.signal(segment_.first + row, task_.model->outputs[static_cast<std::size_t>(j)]);
        residuals[row * outputs_ + j] =
            std::isfinite(measured) ? (run_.outputs(row, j) - measured) / task_.noise[j] : 0.0;
      }
  }
  void FillJacobians(const Episode& episode, const double* q, double** jacobians) const {
    const StateModel& model = *task_.model;
    const int states = model.states(), parameters = model.parameter_count(),
              free = static_cast<int>(free_.size());
    std::size_t block = 0;
    const auto fill = [&](double* out, int from, int count, const auto& factor) {
      Eigen::Map<RowMatrix> to(out, num_residuals(), count);
      to.setZero();
      for (int row = 0; row < rows_; ++row)
        for (int j = 0; j < outputs_; ++j) {
          const int r = row * outputs_ + j;
          if (!std::isfinite(
                  episode.signal(segment_.first + row, model.outputs[static_cast<std::size_t>(j)])))
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

  const FitTask& task_;
  Segment segment_;
  std::vector<int> free_;
  int rows_ = 0, outputs_ = 0;
  mutable StateSimulator simulator_;
  mutable StateRun run_;
  mutable RowMatrix start_slopes_;
};

/// Parameters (scaled) and initial states of each segment.
struct Point {
  std::vector<double> q;
  std::vector<std::vector<double>> z;  ///< per segment: all states over their scale
  double cost = 0;                     ///< half the sum of squares
  bool valid = false;
};

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

/// What the data and limits say of the states at a row; `run`: a run of the model there, nullptr if it diverged.
Eigen::VectorXd GuessedStates(const FitTask& task, const Episode& episode, int row, const StateRun* run,
                              const Eigen::VectorXd& limits) {
  const int states = task.model->states();
  Eigen::VectorXd x(states);
  for (int i = 0; i < states; ++i) {
    const int output = task.model->measured_by[static_cast<std::size_t>(i)];
    const double measured =
        output < 0 ? NAN : episode.signal(row, task.model->outputs[static_cast<std::size_t>(output)]);
    const double low = limits[i], high = limits[states + i];
    if (std::isfinite(measured))
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

std::vector<double> Scaled(const Eigen::VectorXd& x, const Eigen::VectorXd& scale) {
  std::vector<double> z;
  for (Eigen::Index i = 0; i < x.size(); ++i) z.push_back(x[i] / scale[i]);
  return z;
}

Eigen::VectorXd Unscaled(const FitTask& task, const std::vector<double>& q) {
  Eigen::VectorXd theta(static_cast<Eigen::Index>(q.size()));
  for (std::size_t p = 0; p < q.size(); ++p)
    theta[static_cast<Eigen::Index>(p)] = task.scale.FromScaled(p, q[p]);
  return theta;
}

/// A run over a whole episode from the guess at its first row.
void Trial(const FitTask& task, const Eigen::VectorXd& theta, const Episode& episode, StateRun& run) {
  StateSimulator simulator(task.model);
  simulator.SetParameters(theta);
  const Eigen::VectorXd guess = GuessedStates(task, episode, 0, nullptr, simulator.limits());
  simulator.Run(episode, 0, episode.rows() - 1, simulator.Initial(episode, guess), nullptr, run);
}

/// Initial states of all segments from a trial run, the data and the limits.
void GuessSegments(const FitTask& task, const std::vector<Segment>& segments, Point& point) {
  const Eigen::VectorXd theta = Unscaled(task, point.q);
  StateSimulator simulator(task.model);
  simulator.SetParameters(theta);
  StateRun run;
  int tried = -1;
  point.z.clear();
  for (const Segment& segment : segments) {
    const Episode& episode = task.episodes[static_cast<std::size_t>(segment.episode)];
    if (segment.episode != tried) Trial(task, theta, episode, run);
    tried = segment.episode;
    point.z.push_back(
        Scaled(GuessedStates(task, episode, segment.first, &run, simulator.limits()), task.state_scale));
  }
}

/// Minimises from `point`, in place. False: the model diverges there.
bool Minimise(const FitTask& task, const std::vector<Segment>& segments, int iterations, double tolerance,
              bool fixed, Point& point) {
  FLAGS_minloglevel = google::GLOG_FATAL;  // a step that diverges is no news: it is taken back
  ceres::Problem problem;
  const auto parameters = static_cast<int>(point.q.size());
  std::vector<std::vector<double>> free(segments.size());
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const int i : FreeStates(*task.model, segments[s]))
      free[s].push_back(point.z[s][static_cast<std::size_t>(i)]);
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
  simulator.SetParameters(Unscaled(task, point.q));
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
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  point.valid = summary.termination_type != ceres::FAILURE;
  point.cost = summary.final_cost;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const std::vector<int> which = FreeStates(*task.model, segments[s]);
    for (std::size_t k = 0; k < which.size(); ++k)
      point.z[s][static_cast<std::size_t>(which[k])] = free[s][k];
  }
  return point.valid;
}

/// A start fitted with short segments, joints first soft then stiff, then as a whole. Best of that and of the free run alone.
Point FromStart(FitTask task, const Eigen::VectorXd& theta, const StateFitOptions& options) {
  constexpr double kSoft = 0.1, kStiff = 0.01;
  Point start;
  for (std::size_t p = 0; p < task.scale.size(); ++p)
    start.q.push_back(task.scale.ToScaled(p, theta[static_cast<Eigen::Index>(p)]));
  const std::vector<Segment> whole = WholeEpisodes(task.episodes);
  Point best;
  Point shot = start;
  const std::vector<Segment> segments = ShortSegments(task.episodes, options.segment_rows);
  GuessSegments(task, segments, shot);
  bool fine = true;
  for (const double joint : {kSoft, kStiff}) {
    task.joint = joint;
    fine =
        fine && Minimise(task, segments, options.start_iterations / 2, options.start_tolerance, false, shot);
  }
  for (const bool after_shooting : {true, false}) {
    if (after_shooting && !fine) continue;
    Point point = after_shooting ? shot : start;
    GuessSegments(task, whole, point);
    if (after_shooting)  // the episodes begin as their first segments do
      for (std::size_t s = 0, e = 0; s < segments.size(); ++s)
        if (segments[s].first == 0) point.z[e++] = shot.z[s];
    if (Minimise(task, whole, options.start_iterations, options.start_tolerance, false, point) &&
        (!best.valid || point.cost < best.cost))
      best = std::move(point);
  }
  return best;
}

/// The first rows of the episodes, `rows` in all; whole episodes where they fit.
std::vector<Episode> FirstRows(std::span<const Episode> episodes, int rows) {
  std::vector<Episode> out;
  for (const Episode& e : episodes) {
    if (rows <= 1) break;
    const int take = std::min(rows, e.rows());
    out.push_back({e.log, e.first_row, {e.time.begin(), e.time.begin() + take}, e.signal.topRows(take)});
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
        const double y = e.signal(row, model.outputs[static_cast<std::size_t>(j)]);
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

/// Largest size of each state, from data, limits and a run of the model.
Eigen::VectorXd StateScale(const FitTask& task, const Eigen::VectorXd& theta) {
  const int states = task.model->states();
  StateSimulator simulator(task.model);
  simulator.SetParameters(theta);
  StateRun run;
  Trial(task, theta, task.episodes.front(), run);
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(states);
  for (int i = 0; i < states; ++i) {
    const int output = task.model->measured_by[static_cast<std::size_t>(i)];
    double largest = 0;
    if (output >= 0) {
      for (const Episode& e : task.episodes)
        for (int row = 0; row < e.rows(); ++row) {
          const double y = e.signal(row, task.model->outputs[static_cast<std::size_t>(output)]);
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

FitTask TaskOf(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes) {
  constexpr double kFirstNoise = 0.05;  // of an output's variation; found anew once there is a fit
  FitTask task{model, episodes, ParameterScale(*model), {}, {}, 0};
  task.noise = kFirstNoise * OutputScale(*model, episodes);
  Eigen::VectorXd start(model->parameter_count());
  for (int p = 0; p < start.size(); ++p) start[p] = model->parameters[static_cast<std::size_t>(p)].spec.start;
  task.state_scale = StateScale(task, start);
  return task;
}

/// Starts: that of the machine file, then draws from the ranges.
std::vector<Eigen::VectorXd> StartsOf(const FitTask& task, const StateFitOptions& options) {
  const auto count = static_cast<Eigen::Index>(task.scale.size());
  Eigen::VectorXd first(count);
  for (Eigen::Index p = 0; p < count; ++p)
    first[p] = task.model->parameters[static_cast<std::size_t>(p)].spec.start;
  std::vector<Eigen::VectorXd> starts = {first};
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform;
  for (int k = 0; k < options.starts && count > 0; ++k) {
    Eigen::VectorXd drawn = first;
    for (Eigen::Index p = 0; p < count; ++p) {
      const auto at = static_cast<std::size_t>(p);
      const double share = uniform(random);
      if (task.scale.ranged(at))
        drawn[p] = task.scale.FromScaled(
            at, task.scale.low(at) + share * (task.scale.high(at) - task.scale.low(at)));
    }
    starts.push_back(std::move(drawn));
  }
  return starts;
}

/// Information, gradient and energy of pieces of the rows, initial states taken out.
void TakePieces(const FitTask& task, const StateFitOptions& options, StateFit& fit) {
  const int outputs = task.model->output.rows, parameters = task.model->parameter_count();
  const auto episodes = static_cast<int>(task.episodes.size());
  const int parts = std::max(1, (options.least_clusters + episodes - 1) / episodes);
  for (int e = 0; e < episodes; ++e) {
    const auto at = static_cast<std::size_t>(e);
    const Episode& episode = task.episodes[at];
    const StateRun& run = fit.runs[at];
    RowMatrix slopes = run.slopes;
    Eigen::VectorXd error(episode.rows() * outputs);
    for (int row = 0; row < episode.rows(); ++row)
      for (int j = 0; j < outputs; ++j) {
        const int r = row * outputs + j;
        const double residual = fit.residuals[at](row, j);
        const bool good = std::isfinite(residual);
        error[r] = good ? residual / task.noise[j] : 0.0;
        slopes.row(r) *= good ? 1 / task.noise[j] : 0.0;
      }
    const Eigen::Index free = slopes.cols() - parameters;
    RowMatrix by_parameter = slopes.leftCols(parameters);
    if (free > 0) {
      const Eigen::MatrixXd local = slopes.rightCols(free);
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(local);
      const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(local.rows(), free);
      by_parameter -= basis * (basis.transpose() * by_parameter);
      error -= basis * (basis.transpose() * error);
    }
    for (int k = 0; k < parts; ++k) {
      StatePiece piece;
      piece.episode = e;
      piece.first = episode.rows() * k / parts;
      piece.last = episode.rows() * (k + 1) / parts;
      const Eigen::Index first = piece.first * outputs, count = (piece.last - piece.first) * outputs;
      if (count == 0) continue;
      const auto rows = by_parameter.middleRows(first, count);
      const auto errors = error.segment(first, count);
      piece.information = rows.transpose() * rows;
      piece.gradient = rows.transpose() * errors;
      piece.energy = errors.squaredNorm();
      piece.readings = static_cast<int>((errors.array() != 0).count());
      fit.pieces.push_back(std::move(piece));
    }
  }
}

/// Intervals from the residuals as they are: pieces of the log are clusters (Liang and Zeger 1986). Directions of the
/// parameters, each over its size, that change no output beyond what is left are unseen.
void TakeCovariance(const FitTask& task, StateFit& fit) {
  constexpr double kUnseen = 0.7;  // standard error of a relative change that says nothing of it any more
  constexpr double kPart = 0.15;   // of a direction: parameters with less stay unnamed
  const int count = task.model->parameter_count();
  fit.covariance = Eigen::MatrixXd::Zero(count, count);
  if (count == 0) return;
  Eigen::VectorXd size(count);
  for (int p = 0; p < count; ++p) {
    const ParameterSpec& spec = task.model->parameters[static_cast<std::size_t>(p)].spec;
    const double range = std::isfinite(spec.max - spec.min) ? spec.max - spec.min : std::abs(spec.start);
    size[p] = std::max(std::abs(fit.parameters[p]), 1e-3 * range);
    if (size[p] == 0) size[p] = 1;
  }
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count), scatter = information;
  for (const StatePiece& piece : fit.pieces) {
    information += piece.information;
    scatter += piece.gradient * piece.gradient.transpose();
  }
  const double pieces = static_cast<double>(fit.pieces.size());
  if (pieces > 1) scatter *= pieces / (pieces - 1);
  information = size.asDiagonal() * information * size.asDiagonal();
  scatter = size.asDiagonal() * scatter * size.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
  const Eigen::MatrixXd& directions = solver.eigenvectors();
  const double floor = 1e-14 * std::max(solver.eigenvalues().maxCoeff(), 1e-300);
  const Eigen::VectorXd weights = solver.eigenvalues().cwiseMax(floor).cwiseInverse();
  const Eigen::MatrixXd inverse = directions * weights.asDiagonal() * directions.transpose();
  // White residuals make the scatter the information itself: never less than that.
  Eigen::MatrixXd covariance = inverse * scatter * inverse;
  for (int p = 0; p < count; ++p) {
    const double white = inverse(p, p), found = covariance(p, p);
    if (found >= white || !(found > 0)) continue;
    const double factor = std::sqrt(white / found);
    covariance.row(p) *= factor;
    covariance.col(p) *= factor;
  }
  fit.covariance = size.asDiagonal() * covariance * size.asDiagonal();
  for (int d = 0; d < count; ++d) {
    const double standard_error = std::sqrt(weights[d]);
    if (standard_error < kUnseen) continue;
    UnseenDirection unseen;
    const double largest = directions.col(d).cwiseAbs().maxCoeff();
    for (int p = 0; p < count; ++p)
      if (std::abs(directions(p, d)) > kPart * largest)
        unseen.parts.emplace_back(task.model->parameters[static_cast<std::size_t>(p)].name,
                                  directions(p, d) / largest);
    fit.unseen.push_back(std::move(unseen));
  }
}

/// Where a model that diverges does so.
std::string DivergedText(const FitTask& task, const Eigen::VectorXd& theta) {
  for (const Episode& episode : task.episodes) {
    StateRun run;
    Trial(task, theta, episode, run);
    if (!run.diverged) continue;
    Eigen::Index worst = 0;
    run.states.row(run.rows - 1).cwiseAbs().cwiseQuotient(task.state_scale.transpose()).maxCoeff(&worst);
    return fmt::format(
        "the model diverges: from the starting values of the machine file {} runs away {:.4g} s after the "
        "episode's beginning; narrow the ranges in [parameters] or check the signs of its equations",
        task.model->machine.states.states[static_cast<std::size_t>(worst)].name,
        episode.time[static_cast<std::size_t>(run.rows - 1)] - episode.time.front());
  }
  return "the model diverges from every start; narrow the ranges in "
         "[parameters] or check the signs of its equations";
}

/// Runs with sensitivities at a point, residuals, noise.
bool TakeRuns(FitTask& task, const Point& point, StateFit& fit) {
  const StateModel& model = *task.model;
  fit.parameters = Unscaled(task, point.q);
  StateSimulator simulator(task.model);
  simulator.SetParameters(fit.parameters);
  fit.runs.clear();
  fit.residuals.clear();
  fit.initial.clear();
  for (std::size_t e = 0; e < task.episodes.size(); ++e) {
    const Episode& episode = task.episodes[e];
    const std::vector<int> free = FreeStates(model, {static_cast<int>(e), 0, 0, false});
    Eigen::VectorXd given(model.states());
    for (int i = 0; i < model.states(); ++i)
      given[i] = point.z[e][static_cast<std::size_t>(i)] * task.state_scale[i];
    RowMatrix start, by_parameter;
    const Eigen::VectorXd x0 = simulator.Initial(episode, given, &by_parameter);
    start = RowMatrix::Zero(model.states(), model.parameter_count() + static_cast<int>(free.size()));
    start.leftCols(model.parameter_count()) = by_parameter;
    for (std::size_t k = 0; k < free.size(); ++k)
      start(free[k], model.parameter_count() + static_cast<int>(k)) = 1;
    StateRun run;
    simulator.Run(episode, 0, episode.rows() - 1, x0, &start, run);
    if (run.diverged) return false;
    RowMatrix residual(episode.rows(), model.output.rows);
    for (int j = 0; j < model.output.rows; ++j)
      residual.col(j) = episode.signal.col(model.outputs[static_cast<std::size_t>(j)]) - run.outputs.col(j);
    fit.initial.push_back(x0);
    fit.residuals.push_back(std::move(residual));
    fit.runs.push_back(std::move(run));
  }
  return true;
}

/// Fits all rows from a point, twice where several outputs are weighted by their noise.
StateFit Finish(FitTask task, Point point, bool noise_known, bool fixed, const StateFitOptions& options) {
  constexpr double kQuiet = 1e-9;  // of an output's variation: simulated logs without noise
  StateFit fit;
  fit.model = task.model;
  fit.scale = OutputScale(*task.model, task.episodes);
  const std::vector<Segment> whole = WholeEpisodes(task.episodes);
  const int rounds = task.model->output.rows > 1 && !noise_known && !fixed ? 3 : 1;
  for (int round = 0; round < rounds; ++round) {
    if (!Minimise(task, whole, options.iterations, options.tolerance, fixed, point) ||
        !TakeRuns(task, point, fit)) {
      fit.failed = DivergedText(task, Unscaled(task, point.q));
      return fit;
    }
    fit.noise = RmsOf(fit.residuals, task.model->output.rows).cwiseMax(kQuiet * fit.scale);
    if (!noise_known) task.noise = fit.noise;
  }
  TakePieces(task, options, fit);
  TakeCovariance(task, fit);
  for (std::size_t p = 0; p < task.scale.size(); ++p) {
    const double margin = 1e-6 * (1 + std::abs(point.q[p]));
    fit.at_limit.push_back(point.q[p] <= task.scale.low(p) + margin ||
                           point.q[p] >= task.scale.high(p) - margin);
  }
  return fit;
}

}  // namespace

Eigen::VectorXd RmsOf(const std::vector<RowMatrix>& residuals, int outputs) {
  Eigen::VectorXd energy = Eigen::VectorXd::Zero(outputs), count = energy;
  for (const RowMatrix& residual : residuals)
    for (Eigen::Index row = 0; row < residual.rows(); ++row)
      for (int j = 0; j < outputs; ++j)
        if (std::isfinite(residual(row, j))) {
          energy[j] += residual(row, j) * residual(row, j);
          count[j] += 1;
        }
  return energy.cwiseQuotient(count.cwiseMax(1.0)).cwiseSqrt();
}

int StateFit::readings() const {
  int sum = 0;
  for (const StatePiece& piece : pieces) sum += piece.readings;
  return sum;
}

std::vector<double> StateFit::HeldOutEnergies() const {
  std::vector<double> energies;
  const int count = model->parameter_count();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
  for (const StatePiece& piece : pieces) {
    information += piece.information;
    gradient += piece.gradient;
  }
  for (const StatePiece& piece : pieces) {
    if (count == 0) {
      energies.push_back(piece.energy);
      continue;
    }
    Eigen::MatrixXd rest = information - piece.information;
    const Eigen::VectorXd size = rest.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    rest = size.asDiagonal() * rest * size.asDiagonal();
    rest.diagonal().array() += 1e-10;
    const Eigen::VectorXd change =
        size.cwiseProduct(rest.ldlt().solve(size.cwiseProduct(gradient - piece.gradient)));
    // Errors of the piece after the change: r - J change.
    energies.push_back(std::max(
        0.0, piece.energy - 2 * piece.gradient.dot(change) + change.dot(piece.information * change)));
  }
  return energies;
}

double StateFit::HeldOutEnergy() const {
  double sum = 0;
  for (const double energy : HeldOutEnergies()) sum += energy;
  return sum;
}

StateFit FitStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                   const StateFitOptions& options) {
  const std::vector<Episode> few = FirstRows(episodes, options.start_rows);
  const FitTask task = TaskOf(model, few);
  const std::vector<Eigen::VectorXd> starts = StartsOf(task, options);
  struct Candidate {
    Point point;
    int starts = 1;
  };
  std::vector<Candidate> found;
  int diverged = 0;
  for (const Eigen::VectorXd& start : starts) {
    Point point = FromStart(task, start, options);
    if (!point.valid) {
      ++diverged;
      continue;
    }
    const auto same = std::find_if(found.begin(), found.end(), [&](const Candidate& c) {
      return std::abs(c.point.cost - point.cost) <=
             options.same_minimum * std::min(c.point.cost, point.cost) + 1e-12;
    });
    if (same == found.end()) {
      found.push_back({std::move(point)});
      continue;
    }
    ++same->starts;
    if (point.cost < same->point.cost) same->point = std::move(point);
  }
  if (found.empty()) {
    StateFit none;
    none.model = model;
    none.failed = DivergedText(task, starts.front());
    return none;
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.point.cost < b.point.cost; });

  FitTask all = TaskOf(model, episodes);
  all.noise = task.noise;
  all.state_scale = task.state_scale;
  StateFit best;
  double best_energy = 0;
  for (std::size_t k = 0; k < found.size() && k < static_cast<std::size_t>(options.polished); ++k) {
    Point point = found[k].point;
    const std::vector<std::vector<double>> begin = point.z;
    GuessSegments(all, WholeEpisodes(episodes), point);
    std::copy(begin.begin(), begin.end(), point.z.begin());
    StateFit fit = Finish(all, std::move(point), false, false, options);
    const double energy = fit.solved() ? fit.noise.cwiseQuotient(fit.scale).squaredNorm() : 0;
    if (fit.solved() && (!best.model || !best.solved() || energy < best_energy)) {
      best = std::move(fit);
      best_energy = energy;
    } else if (!best.model) {
      best = std::move(fit);
    }
  }
  for (const Candidate& c : found)
    best.minima.push_back({Unscaled(task, c.point.q),
                           std::sqrt(c.point.cost / std::max(found.front().point.cost, 1e-300)), c.starts});
  best.starts_tried = static_cast<int>(starts.size());
  best.starts_diverged = diverged;
  return best;
}

StateFit RefitStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                     const Eigen::VectorXd& start, const std::vector<Eigen::VectorXd>& initial,
                     const Eigen::VectorXd& weights, const StateFitOptions& options) {
  FitTask task = TaskOf(model, episodes);
  if (weights.size() > 0) task.noise = weights;
  Point point;
  for (std::size_t p = 0; p < task.scale.size(); ++p)
    point.q.push_back(task.scale.ToScaled(p, start[static_cast<Eigen::Index>(p)]));
  GuessSegments(task, WholeEpisodes(episodes), point);
  for (std::size_t e = 0; e < initial.size(); ++e) point.z[e] = Scaled(initial[e], task.state_scale);
  return Finish(std::move(task), std::move(point), weights.size() > 0, false, options);
}

StateFit FollowStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                      const Eigen::VectorXd& parameters, const Eigen::VectorXd& weights) {
  FitTask task = TaskOf(model, episodes);
  task.noise = weights;
  Point point;
  for (std::size_t p = 0; p < task.scale.size(); ++p)
    point.q.push_back(task.scale.ToScaled(p, parameters[static_cast<Eigen::Index>(p)]));
  GuessSegments(task, WholeEpisodes(episodes), point);
  return Finish(std::move(task), std::move(point), true, true, {});
}

}  // namespace hydroscope
