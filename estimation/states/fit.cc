#include "estimation/states/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "estimation/states/beginnings.h"
#include "estimation/states/evidence.h"
#include "estimation/states/fit_task.h"
#include "estimation/states/growing.h"
#include "estimation/states/shooting.h"
#include "estimation/states/white_noise.h"

namespace hydroscope {
namespace {

DescentOptions Roughly(const StateFitOptions& options) {
  return {.iterations = options.start_iterations, .tolerance = options.start_tolerance};
}
DescentOptions ToTheEnd(const StateFitOptions& options) {
  return {.iterations = options.iterations, .tolerance = options.tolerance};
}

/// A start fitted with short segments, joints first soft then stiff, then as a whole. Not valid where the model diverges; nothing
/// where segments err far more than the best runs so far, of cost `least`: joints that give way lower what a minimum costs, so that
/// the runs would end in a worse one.
std::optional<shooting::Point> Shot(shooting::Task task, const Eigen::VectorXd& parameters, double least,
                                    const StateFitOptions& options, bool cautious = false) {
  constexpr double kSoft = 0.1, kStiff = 0.01;
  shooting::Point shot = shooting::PointAt(task, parameters);
  const std::vector<shooting::Segment> segments =
      shooting::ShortSegments(task.episodes, options.segment_rows);
  shooting::GuessSegments(task, segments, shot);
  shooting::SeekBeginnings(task, segments, options.segment_rows, shot);
  DescentOptions how{.iterations = options.start_iterations / 2, .tolerance = options.start_tolerance};
  if (cautious) how.first_radius = options.cautious_radius;
  for (const double joint : {kSoft, kStiff}) {
    task.joint = joint;
    if (!shooting::Minimise(task, segments, how, false, shot)) return shooting::Point{};
    if (options.until_agreed > 0 && (shot.converged || joint == kStiff) &&
        shot.cost > options.far_worse * least)
      return std::nullopt;
  }
  const std::vector<shooting::Segment> whole = shooting::WholeEpisodes(task.episodes);
  shooting::Point point = shot;
  shooting::GuessSegments(task, whole, point);
  for (std::size_t s = 0, e = 0; s < segments.size(); ++s)  // the episodes begin as their first segments do
    if (segments[s].first == 0) point.z[e++] = shot.z[s];
  point.valid = shooting::Minimise(task, whole, Roughly(options), false, point);
  return point;
}

/// A start fitted with short segments first, by bold steps; where that ends clearly above the `least` cost of those before, infinite
/// for the first, by cautious ones and as one run alone too: the best. Not valid where the model diverges or ends far above it.
shooting::Point FromStart(const shooting::Task& task, const Eigen::VectorXd& parameters, double least,
                          const StateFitOptions& options) {
  shooting::Point best;
  const auto take = [&](shooting::Point point) {
    if (point.valid && (!best.valid || point.cost < best.cost)) best = std::move(point);
  };
  const auto enough = [&] {
    return best.valid && std::isfinite(least) && best.cost <= (1 + options.same_minimum) * least;
  };
  bool near = false;  // segments do not err far more than the best runs so far
  for (const bool cautious : {false, true}) {
    std::optional<shooting::Point> shot = Shot(task, parameters, least, options, cautious);
    near = near || shot;
    if (shot) take(std::move(*shot));
    if (enough()) return best;
  }
  if (!near) return best;
  shooting::Point alone = shooting::PointAt(task, parameters);
  const std::vector<shooting::Segment> whole = shooting::WholeEpisodes(task.episodes);
  shooting::GuessSegments(task, whole, alone);
  shooting::SeekBeginnings(task, whole, options.segment_rows, alone);
  shooting::Minimise(task, whole, Roughly(options), false, alone);
  take(std::move(alone));
  return best;
}

/// A point of the first rows (shooting::FirstRows) taken on to all of a task, step by step: a free run that is right over them may
/// go astray over the whole record. Where the model diverges on the way the point stays.
shooting::Point TakenOn(const shooting::Task& all, const shooting::Point& few,
                        const StateFitOptions& options) {
  shooting::Point point = few;
  const std::vector<shooting::Segment> whole = shooting::WholeEpisodes(all.episodes);
  shooting::GuessSegments(all, whole, point);
  if (few.z.size() < whole.size()) shooting::SeekBeginnings(all, whole, options.segment_rows, point);
  std::ranges::copy(few.z, point.z.begin());
  const bool longer =
      std::ranges::any_of(all.episodes, [&](const Episode& e) { return e.rows() > options.start_rows; });
  if (!longer || all.scale.size() == 0) return point;
  shooting::Point grown = GrowFrom(all, point, options.start_rows, options);
  return grown.valid ? grown : point;
}

/// Runs with sensitivities at a point, residuals, noise.
bool TakeRuns(shooting::Task& task, const shooting::Point& point, StateFit& fit) {
  const StateModel& model = *task.model;
  const Eigen::VectorXd all = shooting::Unscaled(task, point.q);
  const int parameters = model.parameter_count();
  fit.parameters = all.head(parameters);
  fit.gain = Eigen::Map<const RowMatrix>(all.data() + parameters, task.predicts ? model.states() : 0,
                                         model.output.rows);
  StateSimulator simulator(task.model);
  task.Set(all, simulator);
  fit.runs.clear();
  fit.residuals.clear();
  fit.initial.clear();
  for (std::size_t e = 0; e < task.episodes.size(); ++e) {
    const Episode& episode = task.episodes[e];
    const std::vector<int> free = shooting::FreeStates(model, {static_cast<int>(e), 0, 0, false});
    Eigen::VectorXd given(model.states());
    for (int i = 0; i < model.states(); ++i) given[i] = point.z[e][i] * task.state_scale[i];
    RowMatrix start, by_parameter;
    const Eigen::VectorXd x0 = simulator.Initial(episode, given, &by_parameter);
    start = RowMatrix::Zero(model.states(), all.size() + static_cast<Eigen::Index>(free.size()));
    start.leftCols(parameters) = by_parameter;
    for (std::size_t k = 0; k < free.size(); ++k)
      start(free[k], all.size() + static_cast<Eigen::Index>(k)) = 1;
    StateRun run;
    simulator.Run(episode, 0, episode.rows() - 1, x0, &start, run);
    if (run.diverged) return false;
    RowMatrix residual(episode.rows(), model.output.rows);
    for (int j = 0; j < model.output.rows; ++j)
      residual.col(j) = episode.signal.col(model.outputs[j]) - run.outputs.col(j);
    fit.initial.push_back(x0);
    fit.residuals.push_back(std::move(residual));
    fit.runs.push_back(std::move(run));
  }
  return true;
}

/// Whether a point leaves noise without any memory: there is no better minimum.
bool LeavesWhite(shooting::Task task, const shooting::Point& point) {
  task.effort.reset();
  StateFit fit;
  fit.model = task.model;
  return TakeRuns(task, point, fit) && AreWhite(fit.residuals, task.episodes.front().mean_rows);
}

/// Fits all rows from a point, twice where several outputs are weighted by their noise.
StateFit Finish(shooting::Task task, shooting::Point point, bool noise_known, bool fixed,
                const StateFitOptions& options) {
  constexpr double kQuiet = 1e-9;      // of an output's variation: simulated logs without noise
  constexpr double kSameNoise = 0.02;  // weights that differ by less give the same fit
  StateFit fit;
  fit.model = task.model;
  fit.scale = shooting::OutputScale(*task.model, task.episodes);
  const std::vector<shooting::Segment> whole = shooting::WholeEpisodes(task.episodes);
  const int rounds = (task.model->output.rows > 1 || task.predicts) && !noise_known && !fixed ? 3 : 1;
  // Many readings: normal equations cost a fraction of a QR decomposition.
  const bool normal = SeesMuch(*task.model) && !fixed && !task.predicts;
  for (int round = 0; round < rounds; ++round) {
    const bool fine = normal ? PolishWhole(task, options, point)
                             : shooting::Minimise(task, whole, ToTheEnd(options), fixed, point);
    if (!fine || !TakeRuns(task, point, fit)) {
      fit.failed = shooting::DivergedText(task, shooting::Unscaled(task, point.q));
      return fit;
    }
    fit.noise = RmsOf(fit.residuals, task.model->output.rows).cwiseMax(kQuiet * fit.scale);
    const bool same = (fit.noise - task.noise).cwiseQuotient(task.noise).cwiseAbs().maxCoeff() < kSameNoise;
    if (!noise_known) task.noise = fit.noise;
    if (same) break;
  }
  // Intervals are those of the noise that is left, whatever weights energies are compared by.
  shooting::Task as_left = task;
  as_left.noise = fit.noise;
  TakePieces(as_left, options, fit);
  TakeCovariance(as_left, fit);
  if (noise_known) TakePieces(task, options, fit);
  for (std::size_t p = 0; p < static_cast<std::size_t>(task.model->parameter_count()); ++p) {
    const double margin = 1e-6 * (1 + std::abs(point.q[p]));
    fit.at_limit.push_back(point.q[p] <= task.scale.low(p) + margin ||
                           point.q[p] >= task.scale.high(p) - margin);
  }
  return fit;
}

}  // namespace

StateFitOptions BestAlone() {
  StateFitOptions options;
  options.until_white = true;
  options.until_agreed = kEnoughStarts;
  return options;
}

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

namespace {

/// Half the sum of the squares of what a fit leaves over `noise`, per output; infinite where there is no fit.
double CostOf(const StateFit& fit, const Eigen::VectorXd& noise) {
  if (!fit.solved()) return std::numeric_limits<double>::infinity();
  return 0.5 * fit.readings() * fit.noise.cwiseQuotient(noise).squaredNorm() /
         static_cast<double>(noise.size());
}

/// Starts one after the other over a growing horizon, until one leaves no more than white noise or ends where the best did.
StateFit FitStarts(shooting::Task task, const StateFitOptions& options) {
  task.noise = WhiteNoise(*task.model, task.episodes, shooting::OutputScale(*task.model, task.episodes));
  // What few outputs see leads astray from far off.
  const std::vector<Eigen::VectorXd> starts = shooting::StartsOf(task, options, !SeesMuch(*task.model));
  double readings = 0;
  for (const Episode& e : task.episodes)
    readings += static_cast<double>(e.rows() / e.mean_rows * task.model->output.rows);
  struct Reached {
    StateMinimum minimum;
    shooting::Point point;  // the best of its starts
    Eigen::VectorXd begun;  // where the first of them began
  };
  std::vector<Reached> reached;
  double least = std::numeric_limits<double>::infinity();
  int tried = 0, diverged = 0;
  bool white = false;  // the last start leaves white noise
  for (const Eigen::VectorXd& start : starts) {
    ++tried;
    if (options.tells_start) options.tells_start(tried, starts.size());
    shooting::Point point = FitGrowing(task, start, options);
    if (!point.valid) {
      ++diverged;
      continue;
    }
    // Of an output that moves faster than its readings the noise is at most so much: what is left must be white as well. Where
    // the cost is flat a start stops short of that, and is fitted to the end before it is judged.
    const bool quiet = 2 * point.cost <= options.at_noise * readings;
    white = quiet && LeavesWhite(task, point);
    if (quiet && !white && !SeesMuch(*task.model))
      white =
          shooting::Minimise(task, shooting::WholeEpisodes(task.episodes), ToTheEnd(options), false, point) &&
          LeavesWhite(task, point);
    least = std::min(least, point.cost);
    const auto same = std::ranges::find_if(reached, [&](const Reached& r) {
      return std::abs(r.minimum.cost - point.cost) <=
             options.same_minimum * std::min(r.minimum.cost, point.cost);
    });
    bool again = false;
    if (same != reached.end()) {
      ++same->minimum.starts;
      again = shooting::FarApart(task.scale, same->begun, start) &&
              same->minimum.cost <= (1 + options.same_minimum) * least;
      if (point.cost < same->point.cost) same->point = std::move(point);
    } else {
      StateMinimum minimum{shooting::Unscaled(task, point.q), point.cost, 1};
      reached.push_back({std::move(minimum), std::move(point), start});
    }
    // The best minimum again, from elsewhere: there is hardly a better one.
    if (again || white) break;
  }
  if (reached.empty()) {
    StateFit none;
    none.model = task.model;
    none.failed = shooting::DivergedText(task, starts.front());
    return none;
  }
  std::ranges::sort(reached, {}, [](const Reached& r) { return r.point.cost; });
  // A start that one output leads astray stops short where the cost is flat: there two of the last fits must agree.
  constexpr double kSameFit = 2e-3;
  const std::ptrdiff_t enough = SeesMuch(*task.model) || white ? 1 : 2;
  StateFit fit;
  least = std::numeric_limits<double>::infinity();
  for (auto r = reached.begin(); r != reached.end(); ++r) {
    StateFit last = Finish(task, r->point, false, false, options);
    r->minimum.cost = CostOf(last, task.noise);
    if (last.solved()) r->minimum.parameters = last.parameters;
    if (r == reached.begin() || r->minimum.cost < least) fit = std::move(last);
    least = std::min(least, r->minimum.cost);
    if (std::count_if(reached.begin(), r + 1, [&](const Reached& other) {
          return other.minimum.cost <= (1 + kSameFit) * least;
        }) >= enough)
      break;
  }
  std::erase_if(reached, [](const Reached& r) { return !std::isfinite(r.minimum.cost); });
  std::ranges::sort(reached, {}, [](const Reached& r) { return r.minimum.cost; });
  for (const auto& [minimum, point, begun] : reached) {
    const double cost = std::sqrt(minimum.cost / std::max(least, 1e-300));
    if (!fit.minima.empty() && minimum.cost <= (1 + options.same_minimum) * least)
      fit.minima.front().starts += minimum.starts;
    else
      fit.minima.push_back({minimum.parameters, cost, minimum.starts});
  }
  fit.starts_tried = tried;
  fit.starts_diverged = diverged;
  return fit;
}

/// Minima that several starts reached, best first, and how the starts went.
struct MinimaSearch {
  struct Minimum {
    shooting::Point point;
    std::vector<Eigen::VectorXd> ends;  ///< parameters of each start
  };
  std::vector<Minimum> minima;
  int tried = 0, diverged = 0;

  /// The minimum that a start ended in, with it.
  const Minimum& Add(shooting::Point point, const Eigen::VectorXd& end, double same_minimum) {
    auto same = std::ranges::find_if(minima, [&](const Minimum& m) {
      return std::abs(m.point.cost - point.cost) <= same_minimum * std::min(m.point.cost, point.cost) + 1e-12;
    });
    if (same == minima.end()) same = minima.insert(same, {point, {}});
    same->ends.push_back(end);
    if (point.cost < same->point.cost) same->point = std::move(point);
    return *same;
  }
};

/// Whether so many starts as options.until_agreed ended with the same parameters in this minimum.
bool HaveAgreed(const shooting::Task& task, const MinimaSearch::Minimum& minimum,
                const StateFitOptions& options) {
  if (options.until_agreed <= 0) return false;
  const auto same = [&](const Eigen::VectorXd& other) {
    return shooting::SameEnd(task.scale, minimum.ends.back(), other);
  };
  const bool known = options.ended.size() > 0 && same(options.ended);
  return std::ranges::count_if(minimum.ends, same) + (known ? 1 : 0) >= options.until_agreed;
}

/// A start that costs far more than those before it is given up.
MinimaSearch FindMinima(shooting::Task task, const std::vector<Eigen::VectorXd>& starts,
                        const StateFitOptions& options) {
  task.effort = std::make_shared<shooting::Effort>();
  MinimaSearch search;
  double least = std::numeric_limits<double>::infinity();
  std::int64_t spent = 0;
  for (const Eigen::VectorXd& start : starts) {
    ++search.tried;
    if (options.tells_start) options.tells_start(search.tried, starts.size());
    task.effort->spent = 0;
    shooting::Point point = FromStart(task, start, least, options);
    if (!point.valid) {
      ++search.diverged;
      continue;
    }
    spent += task.effort->spent;
    task.effort->most = static_cast<std::int64_t>(options.most_effort * static_cast<double>(spent) /
                                                  (search.tried - search.diverged));
    const bool white = options.until_white && point.cost < least && LeavesWhite(task, point);
    least = std::min(least, point.cost);
    const Eigen::VectorXd end = shooting::Unscaled(task, point.q);
    const MinimaSearch::Minimum& minimum = search.Add(std::move(point), end, options.same_minimum);
    if (white || (minimum.point.cost <= least && HaveAgreed(task, minimum, options))) break;
  }
  std::ranges::sort(search.minima, [](const auto& a, const auto& b) { return a.point.cost < b.point.cost; });
  return search;
}

}  // namespace

StateFit FitStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                   const StateFitOptions& options) {
  if (GrowsHorizon(*model)) return FitStarts(shooting::TaskOf(model, episodes), options);
  const std::vector<Episode> few = shooting::FirstRows(episodes, options.start_rows);
  const shooting::Task task = shooting::TaskOf(model, few);
  const std::vector<Eigen::VectorXd> starts = shooting::StartsOf(task, options);
  const auto [found, tried, diverged] = FindMinima(task, starts, options);
  if (found.empty()) {
    StateFit none;
    none.model = model;
    none.failed = shooting::DivergedText(task, starts.front());
    return none;
  }

  shooting::Task all = shooting::TaskOf(model, episodes);
  all.noise = task.noise;
  all.state_scale = task.state_scale;
  StateFit best;
  double best_energy = 0;
  for (std::size_t k = 0; k < found.size() && k < static_cast<std::size_t>(options.polished); ++k) {
    shooting::Point point = TakenOn(all, found[k].point, options);
    StateFit fit = Finish(all, std::move(point), false, false, options);
    const double energy = fit.solved() ? fit.noise.cwiseQuotient(fit.scale).squaredNorm() : 0;
    if (fit.solved() && (!best.model || !best.solved() || energy < best_energy)) {
      best = std::move(fit);
      best_energy = energy;
    } else if (!best.model) {
      best = std::move(fit);
    }
  }
  for (const auto& [point, ends] : found)
    best.minima.push_back({shooting::Unscaled(task, point.q),
                           std::sqrt(point.cost / std::max(found.front().point.cost, 1e-300)),
                           static_cast<int>(ends.size())});
  best.starts_tried = tried;
  best.starts_diverged = diverged;
  return best;
}

StateFit RefitStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                     std::span<const StateStart> starts, const Eigen::VectorXd& weights,
                     const StateFitOptions& options) {
  shooting::Task task = shooting::TaskOf(model, episodes);
  if (weights.size() > 0) task.noise = weights;
  const std::vector<shooting::Segment> whole = shooting::WholeEpisodes(episodes);
  shooting::Point best;
  for (const StateStart& start : starts) {
    shooting::Point point = shooting::PointAt(task, start.parameters);
    shooting::GuessSegments(task, whole, point);
    if (start.initial.empty()) shooting::SeekBeginnings(task, whole, options.segment_rows, point);
    for (std::size_t e = 0; e < start.initial.size(); ++e)
      point.z[e] = shooting::Scaled(start.initial[e], task.state_scale);
    if (starts.size() > 1 && !shooting::Minimise(task, whole, Roughly(options), false, point)) continue;
    if (best.z.empty() || point.cost < best.cost) best = std::move(point);
  }
  if (best.z.empty()) {
    StateFit none;
    none.model = model;
    none.failed = shooting::DivergedText(task, starts.front().parameters);
    return none;
  }
  return Finish(std::move(task), std::move(best), weights.size() > 0, false, options);
}

std::optional<StateStart> ShootStart(std::shared_ptr<const StateModel> model,
                                     std::span<const Episode> episodes, const Eigen::VectorXd& parameters,
                                     const StateFitOptions& options) {
  const std::vector<Episode> few = shooting::FirstRows(episodes, options.start_rows);
  const shooting::Task task = shooting::TaskOf(model, few);
  const shooting::Point shot = Shot(task, parameters, kInfinity, options).value();
  if (!shot.valid) return std::nullopt;
  shooting::Task all = task;
  all.episodes = episodes;
  const shooting::Point point = TakenOn(all, shot, options);
  StateStart start{shooting::Unscaled(task, point.q), {}};
  for (const std::vector<double>& z : point.z)
    start.initial.push_back(Eigen::Map<const Eigen::VectorXd>(z.data(), static_cast<Eigen::Index>(z.size()))
                                .cwiseProduct(task.state_scale));
  return start;
}

StateFit PredictStates(const StateFit& free_run, std::span<const Episode> episodes,
                       const StateFitOptions& options) {
  constexpr double kFirstGain = 0.3;  // of a state that is measured itself
  const StateModel& model = *free_run.model;
  shooting::Task task = shooting::TaskOf(free_run.model, episodes);
  task.noise = free_run.noise;
  shooting::Point point = shooting::PointAt(task, free_run.parameters);
  shooting::GuessSegments(task, shooting::WholeEpisodes(episodes), point);
  for (std::size_t e = 0; e < free_run.initial.size(); ++e)
    point.z[e] = shooting::Scaled(free_run.initial[e], task.state_scale);
  task.predicts = true;
  for (int i = 0; i < model.states(); ++i)
    for (int j = 0; j < model.output.rows; ++j) {
      const double size = task.state_scale[i] / free_run.scale[j];
      task.scale.AddFree(size);
      point.q.push_back(model.measured_by[i] == j ? kFirstGain / size : 0.0);
    }
  return Finish(std::move(task), std::move(point), false, false, options);
}

StateFit FollowStates(std::shared_ptr<const StateModel> model, std::span<const Episode> episodes,
                      const Eigen::VectorXd& parameters, const Eigen::VectorXd& weights) {
  shooting::Task task = shooting::TaskOf(model, episodes);
  task.noise = weights;
  const StateFitOptions options;
  shooting::Point point = shooting::PointAt(task, parameters);
  for (const Episode& episode : episodes)
    point.z.push_back(shooting::BeginningOf(task, episode, parameters, options));
  return Finish(std::move(task), std::move(point), true, true, options);
}

}  // namespace hydroscope
