#include "estimation/linear_form/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "core/nearest_or_all.h"
#include "estimation/linear_form/linear_fit.h"
#include "models/expressions/check.h"

namespace hydroscope {
namespace {

constexpr double kRow = 0.02;  // s, of the trajectory as it is judged

/// Largest deviation from the centre, speed and acceleration over a period.
struct Extremes {
  double up = 0, down = 0, speed = 0, acceleration = 0;
};
Extremes ExtremesOf(const SignalSeries& series, double period) {
  Extremes out;
  const double w = 2 * std::numbers::pi / period;
  for (double t = 0; t < period; t += kRow) {
    double value = 0, speed = 0, acceleration = 0;
    for (std::size_t k = 0; k < series.sine.size(); ++k) {
      const double n = static_cast<double>(k + 1) * w, s = std::sin(n * t), c = std::cos(n * t);
      value += series.sine[k] * s + series.cosine[k] * c;
      speed += n * (series.sine[k] * c - series.cosine[k] * s);
      acceleration -= n * n * (series.sine[k] * s + series.cosine[k] * c);
    }
    out.up = std::max(out.up, value);
    out.down = std::max(out.down, -value);
    out.speed = std::max(out.speed, std::abs(speed));
    out.acceleration = std::max(out.acceleration, std::abs(acceleration));
  }
  return out;
}

/// As large as the limits let it be, in the middle of its range.
void FillLimits(const TrajectoryLimits& limits, double period, SignalSeries& series) {
  const Extremes e = ExtremesOf(series, period);
  const double scale = std::min({(limits.high - limits.low) / std::max(e.up + e.down, 1e-300),
                                 limits.speed / std::max(e.speed, 1e-300),
                                 limits.acceleration / std::max(e.acceleration, 1e-300)});
  for (std::vector<double>* part : {&series.sine, &series.cosine})
    for (double& value : *part) value *= scale;
  series.centre = 0.5 * (limits.low + limits.high) - 0.5 * scale * (e.up - e.down);
}

/// The equations whose terms read driven signals and their rates alone.
LinearForm Plannable(const LinearForm& form, const Machine& machine, const std::set<std::string>& driven) {
  std::set<std::string> known = driven;
  for (const auto& [signal, rate] : form.rates)
    if (driven.contains(signal)) known.insert(rate);
  for (const auto& [name, value] : ExpressionNamesOf(machine).constants) known.insert(name);
  const auto readable = [&](const std::string& text) {
    const auto tree = ParseExpression(text);
    if (text.empty() || !tree) return true;
    const std::set<std::string> names = NamesIn(**tree);
    return std::ranges::all_of(names, [&](const std::string& n) { return known.contains(n); });
  };
  LinearForm out{form.rates, {}, {}};
  std::set<std::string> parameters;
  for (LinearForm::Equation equation : form.equations) {
    if (!std::ranges::all_of(equation.terms,
                             [&](const auto& term) { return readable(term.rate) && readable(term.level); }))
      continue;
    equation.known_rate = "";
    equation.known_level = "0*" + form.rates.front().second;
    for (const LinearForm::Term& term : equation.terms) parameters.insert(term.parameter);
    out.equations.push_back(std::move(equation));
  }
  for (const std::string& name : form.parameters)
    if (parameters.contains(name)) out.parameters.push_back(name);
  return out;
}

class Designer {
 public:
  Designer(LinearForm form, const Machine& machine, const std::vector<TrajectoryLimits>& limits,
           const TrajectoryOptions& options)
      : form_(std::move(form)),
        machine_(machine),
        limits_(limits),
        options_(options),
        random_(options.seed) {}

  Trajectory Run() {
    Trajectory best;
    best.period = options_.period;
    for (int trial = 0; trial < options_.trials; ++trial) {
      // The first tenth is drawn anew each time, then the best so far is changed by less and less.
      const double change = 0.5 * (1 - static_cast<double>(trial) / options_.trials);
      const bool drawn = trial < std::max(1, options_.trials / 10);
      std::vector<SignalSeries> candidate;
      for (std::size_t i = 0; i < limits_.size(); ++i)
        candidate.push_back(drawn ? Drawn(limits_[i]) : Changed(best.signals[i], limits_[i], change));
      const BaseParameterSet base = BaseOf(candidate);
      if (trial == 0) best.first_condition = base.condition;
      const bool more = base.rank > rank_;
      if (!more && (base.rank < rank_ || base.condition >= best.condition)) continue;
      rank_ = base.rank;
      best.condition = base.condition;
      best.signals = std::move(candidate);
      best.shown.clear();
      for (std::size_t k = 0; k < base.kept.size(); ++k)
        best.shown.push_back(BaseParameterText(form_, base, k));
    }
    return best;
  }

 private:
  SignalSeries Drawn(const TrajectoryLimits& limits) {
    SignalSeries series{limits.signal, 0, {}, {}};
    std::normal_distribution<double> normal;
    for (int k = 1; k <= options_.terms; ++k) {
      series.sine.push_back(normal(random_) / k);
      series.cosine.push_back(normal(random_) / k);
    }
    FillLimits(limits, options_.period, series);
    return series;
  }
  SignalSeries Changed(SignalSeries series, const TrajectoryLimits& limits, double change) {
    double size = 0;
    for (std::size_t k = 0; k < series.sine.size(); ++k)
      size = std::max({size, std::abs(series.sine[k]), std::abs(series.cosine[k])});
    std::normal_distribution<double> normal;
    for (std::vector<double>* part : {&series.sine, &series.cosine})
      for (std::size_t k = 0; k < part->size(); ++k)
        (*part)[k] += change * size * normal(random_) / static_cast<double>(k + 1);
    FillLimits(limits, options_.period, series);
    return series;
  }

  BaseParameterSet BaseOf(const std::vector<SignalSeries>& signals) const {
    Episode episode;
    const int rows = static_cast<int>(options_.period / kRow);
    episode.signal = RowMatrix::Zero(rows, static_cast<Eigen::Index>(machine_.signals.size()));
    for (int k = 0; k < rows; ++k) {
      episode.time.push_back(k * kRow);
      for (const SignalSeries& s : signals)
        episode.signal(k, machine_.SignalIndex(s.signal)) = s.Value(k * kRow, options_.period);
    }
    const WindowEquations windows = WindowsOf(form_, machine_, std::span(&episode, 1));
    Eigen::MatrixXd all(0, static_cast<Eigen::Index>(form_.parameters.size()));
    for (const Eigen::MatrixXd& regressor : windows.regressor) {
      all.conservativeResize(all.rows() + regressor.rows(), Eigen::NoChange);
      all.bottomRows(regressor.rows()) = regressor;
    }
    return FindBaseParameters(all);
  }

  LinearForm form_;
  const Machine& machine_;
  const std::vector<TrajectoryLimits>& limits_;
  TrajectoryOptions options_;
  std::mt19937 random_;
  int rank_ = -1;
};

}  // namespace

double SignalSeries::Value(double time, double period) const {
  double value = centre;
  for (std::size_t k = 0; k < sine.size(); ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k + 1) * time / period;
    value += sine[k] * std::sin(angle) + cosine[k] * std::cos(angle);
  }
  return value;
}

Result<Trajectory> DesignTrajectory(const LinearForm& form, const Machine& machine,
                                    const std::vector<TrajectoryLimits>& limits,
                                    const TrajectoryOptions& options) {
  std::set<std::string> driven;
  for (const TrajectoryLimits& l : limits) {
    if (machine.SignalIndex(l.signal) < 0) {
      std::vector<std::string> names;
      for (const SignalSpec& signal : machine.signals) names.push_back(signal.name);
      return UsageError("'{}' is no signal of the machine file; {}", l.signal, NearestOrAll(l.signal, names));
    }
    if (!(l.low < l.high && l.speed > 0 && l.acceleration > 0))
      return UsageError("{}: a range {} to {}, speed {} and acceleration {} leave no room to move", l.signal,
                        l.low, l.high, l.speed, l.acceleration);
    driven.insert(l.signal);
  }
  LinearForm plannable = Plannable(form, machine, driven);
  if (plannable.equations.empty())
    return UsageError("no equation of '{}' depends on these signals alone", machine.name);
  return Designer(std::move(plannable), machine, limits, options).Run();
}

}  // namespace hydroscope
