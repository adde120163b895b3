#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/constants.h"
#include "estimation/states/bounded_squares.h"
#include "estimation/states/simulation.h"

/// Fitting a model with states by the squares of its errors over segments of episodes, whose initial states are free and which
/// may be joined to one another (multiple shooting, Bock 1981); whole episodes are segments without joints.
namespace hydroscope::shooting {

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
  /// One more, of any value; `size`: what is a large change of it.
  void AddFree(double size) { entries_.push_back({false, size, -kInfinity, kInfinity}); }
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

/// What runs of one start cost so far (StateSimulator::work), and what they may.
struct Effort {
  std::int64_t spent = 0, most = std::numeric_limits<std::int64_t>::max();
  bool exhausted() const { return spent > most; }
};

/// What all segments share.
struct Task {
  std::shared_ptr<const StateModel> model;
  std::span<const Episode> episodes;
  ParameterScale scale;
  Eigen::VectorXd noise;        ///< per output
  Eigen::VectorXd state_scale;  ///< per state
  double joint = 0;             ///< standard deviation of a joint, in state_scale
  /// Parameters are followed by the gains of the innovations form (StateSimulator::SetGain).
  bool predicts = false;
  std::shared_ptr<Effort> effort;  ///< what exceeds it counts as diverged; null: nothing does

  bool GivenUp() const { return effort && effort->exhausted(); }
  void Run(const Episode& episode, const Segment& segment, const Eigen::VectorXd& x0,
           const RowMatrix* start_slopes, StateSimulator& simulator, StateRun& run) const {
    const std::int64_t before = simulator.work();
    simulator.Run(episode, segment.first, segment.last, x0, start_slopes, run);
    if (effort) effort->spent += simulator.work() - before;
    run.diverged = run.diverged || GivenUp();
  }
  int gains() const { return predicts ? model->states() * model->output.rows : 0; }
  /// Of a run: parameters, with the gains behind them.
  void Set(const Eigen::VectorXd& all, StateSimulator& simulator) const {
    simulator.SetParameters(all.head(model->parameter_count()));
    if (predicts)
      simulator.SetGain(Eigen::Map<const RowMatrix>(all.data() + model->parameter_count(), model->states(),
                                                    model->output.rows));
  }
};

/// Parameters (scaled) and initial states of each segment.
struct Point {
  std::vector<double> q;
  std::vector<std::vector<double>> z;  ///< per segment: all states over their scale
  double cost = 0;                     ///< half the sum of squares
  bool valid = false;
  bool converged = false;  ///< to the tolerance, in fewer iterations than it might have taken
};

/// States whose initial value is free in a segment.
std::vector<int> FreeStates(const StateModel& model, const Segment& segment);

std::vector<Segment> WholeEpisodes(std::span<const Episode> episodes);
/// Segments of `rows` rows, joined within each episode.
std::vector<Segment> ShortSegments(std::span<const Episode> episodes, int rows);

std::vector<double> Scaled(const Eigen::VectorXd& x, const Eigen::VectorXd& scale);
Eigen::VectorXd Unscaled(const Task& task, const std::vector<double>& q);

/// A run over a whole episode from what the data and limits say of its first row.
void Trial(const Task& task, const Eigen::VectorXd& theta, const Episode& episode, StateRun& run);
/// Initial states of all segments from a trial run, the data and the limits.
void GuessSegments(const Task& task, const std::vector<Segment>& segments, Point& point);

/// Minimises from `point`, in place; `fixed`: over the initial states alone. False: the model diverges there.
bool Minimise(const Task& task, const std::vector<Segment>& segments, const DescentOptions& how, bool fixed,
              Point& point);

}  // namespace hydroscope::shooting
