#include "estimation/frequency_response/model.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/constants.h"
#include "core/distributions.h"
#include "core/non_negative.h"
#include "core/told_error.h"
#include "estimation/decompositions.h"
#include "estimation/frequency_response/figures.h"
#include "estimation/frequency_response/fit_problem.h"
#include "estimation/frequency_response/second_order.h"

namespace hydroscope {
namespace {

using Vector4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;

// Above, the second pole lies a hundred times above the first: the response is of first order for any sweep.
constexpr double kLargestDamping = 5;
constexpr double kLeastDamping = 0.01;  // of a start

constexpr double kManyDegrees = 1e6;    // of freedom, at which Student's t is a normal distribution
constexpr double kIndependent = 1e-12;  // least eigenvalue of scaled normal equations that points determine
// Chance of a smaller chi^2 from noise alone, from which intervals are widened.
constexpr double kMisfitBeyondNoise = 0.95;

double TFactor(double dof) {
  if (!(dof < kManyDegrees)) return 1;
  return StudentHalfWidth95(std::max(dof, 1.0)) / kNormal95;
}

/// The paper's linear equation of the squared gain, weighted; false if it has no physical solution.
bool SquaredGainStart(const FitProblem& problem, double& omega_0, double& damping) {
  const double scale = problem.time_scale();  // keeps the columns of one size
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Target& target : problem.targets()) {
    const double squared = std::norm(target.response), w = target.omega / scale;
    const Eigen::Vector3d row(w * w * squared, -w * w * w * w * squared, 1);
    const double weight = 1 / (4 * squared * target.variance);
    normal += weight * row * row.transpose();
    right += weight * squared * row;
  }
  const Eigen::Vector3d theta = SymmetricFactor(normal).Solve(right);
  if (!(theta(1) > 0) || !(theta(2) > 0)) return false;
  omega_0 = scale / std::pow(theta(1), 0.25);
  const double damping_squared = (2 - theta(0) / std::sqrt(theta(1))) / 4;
  damping = std::max(std::sqrt(std::max(damping_squared, 0.0)), kLeastDamping);
  return std::isfinite(omega_0);
}

/// Starting points are taken from a grid: natural frequencies from the lowest point over `kGridBefore` to the highest times `kGridBeyond`.
constexpr double kGridBefore = 2, kGridBeyond = 6, kGridStep = 1.3;
constexpr std::array kDampings = {0.1, 0.2, 0.4, 0.7, 1.0, 1.6, 3.0};
constexpr std::size_t kStarts = 5;

/// The few best starting points, best first.
std::vector<Vector4> Starts(const FitProblem& problem) {
  std::vector<std::pair<double, Vector4>> candidates;
  const double last = kGridBeyond * problem.highest();
  for (double omega_0 = problem.lowest() / kGridBefore; omega_0 <= last; omega_0 *= kGridStep) {
    for (const double damping : kDampings) {
      const Vector4 p = problem.Complete(omega_0, damping);
      candidates.emplace_back(problem.Cost(p), p);
    }
  }
  std::ranges::sort(candidates, [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vector4> starts;
  double omega_0 = 0, damping = 0;
  if (SquaredGainStart(problem, omega_0, damping)) starts.push_back(problem.Complete(omega_0, damping));
  for (std::size_t i = 0; i < candidates.size() && starts.size() < kStarts; ++i)
    starts.push_back(candidates[i].second);
  return starts;
}

/// The problem as Ceres asks for it.
struct MisfitOfPoints {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 4 };

  const FitProblem& problem;
  bool hold_damping = false;

  int NumResiduals() const { return static_cast<int>(2 * problem.targets().size()); }
  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    problem.Residuals(Eigen::Map<const Vector4>(parameters), residuals, jacobian);
    // Without a slope there is no step.
    if (jacobian && hold_damping) std::fill_n(jacobian + kLogDamping * NumResiduals(), NumResiduals(), 0.0);
    return true;
  }
};

struct Linearisation {
  Eigen::VectorXd residuals;
  Eigen::Matrix<double, Eigen::Dynamic, 4> jacobian;
};

Linearisation Linearised(const FitProblem& problem, const Vector4& p) {
  const auto rows = static_cast<std::ptrdiff_t>(2 * problem.targets().size());
  Linearisation at{Eigen::VectorXd(rows), Eigen::Matrix<double, Eigen::Dynamic, 4>(rows, 4)};
  problem.Residuals(p, at.residuals.data(), at.jacobian.data());
  return at;
}

struct PolishOptions {
  bool hold_damping = false;
  int most_iterations = 200;
};

/// Levenberg-Marquardt (Ceres) from `p` to the next minimum; returns its cost.
double Polish(const FitProblem& problem, Vector4& p, const PolishOptions& options = {}) {
  ceres::TinySolver<MisfitOfPoints> solver;
  solver.options.function_tolerance = 1e-8;  // of chi^2: 1 is a standard deviation
  solver.options.parameter_tolerance = 1e-12;
  solver.options.gradient_tolerance = 0;
  solver.options.cost_threshold = 0;
  solver.options.max_num_iterations = options.most_iterations;
  const double cost = 2 * solver.Solve({problem, options.hold_damping}, &p).final_cost;
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

struct Minimum {
  Vector4 p = Vector4::Zero();
  double cost = std::numeric_limits<double>::infinity();
  bool first_order = false;  ///< damping ran to its limit
};

// Points that the search for starting values looks at: more do not tell one valley from another.
constexpr std::size_t kPointsOfSearch = 32;
// Nor do more iterations: a response of first order has no bottom, its damping grows and grows.
constexpr int kIterationsOfSearch = 12;

/// The deepest valley that the starts lead into, seen from few points.
Minimum DeepestValley(const FitProblem& problem) {
  Minimum best;
  for (Vector4 p : Starts(problem)) {
    const double cost = Polish(problem, p, {.most_iterations = kIterationsOfSearch});
    if (cost < best.cost) best = {p, cost, false};
  }
  return best;
}

/// Parameters of a model, half a sample of hold counted as dead time.
Vector4 ParametersOf(const ValveModel& model, double time_scale) {
  return {std::log(kTwoPi * model.natural_frequency.value), std::log(model.damping.value), model.gain.value,
          (model.dead_time.value + model.command_hold / 2) * time_scale};
}

/// Where the damping is at its limit f0 and D only matter as f0/(2 D): D is held and the rest settles.
Minimum AtLargestDamping(const FitProblem& problem, const Vector4& p) {
  const double corner = std::exp(p(kLogOmega) - p(kLogDamping)) / 2;
  const FitProblem thinned = problem.Thinned(kPointsOfSearch);
  Minimum held{thinned.Complete(2 * kLargestDamping * corner, kLargestDamping), 0, true};
  Polish(thinned, held.p, {.hold_damping = true});
  held.cost = Polish(problem, held.p, {.hold_damping = true});
  return held;
}

/// More damping would fit better still.
bool WantsMoreDamping(const FitProblem& problem, const Vector4& p) {
  const auto [residuals, jacobian] = Linearised(problem, p);
  return jacobian.col(kLogDamping).dot(residuals) < 0;
}

Minimum FindMinimum(const FitProblem& problem, const ValveModel* near) {
  Minimum found;
  found.p =
      near ? ParametersOf(*near, problem.time_scale()) : DeepestValley(problem.Thinned(kPointsOfSearch)).p;
  const double limit = std::log(kLargestDamping) - 1e-9;
  if (found.p(kLogDamping) > limit) {
    const Minimum held = AtLargestDamping(problem, found.p);
    if (WantsMoreDamping(problem, held.p)) return held;
    found.p = held.p;
  }
  found.cost = Polish(problem, found.p);
  return found.p(kLogDamping) > limit ? AtLargestDamping(problem, found.p) : found;
}

/// Inverse of the normal matrix; false if a combination of the parameters has no effect at all.
bool Covariance(const FitProblem& problem, const Vector4& p, Matrix4& covariance) {
  const auto jacobian = Linearised(problem, p).jacobian;
  const Matrix4 normal = jacobian.transpose() * jacobian;
  const Vector4 scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix4 scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  if (!scaled.allFinite()) return false;
  if (!(EigenOf(scaled).values[0] > kIndependent)) return false;
  covariance = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  return true;
}

/// Factor on every std: misfit beyond the noise, and Student's t where degrees of freedom are few.
double WidenIntervals(const FitProblem& problem, double correlation, ValveModel& model) {
  double from_points = 0, expected = 0;
  for (const Target& target : problem.targets()) {
    from_points += std::min(target.dof, kManyDegrees);
    expected += target.dof > 4 ? target.dof / (target.dof - 2) : 2;
  }
  expected /= static_cast<double>(problem.targets().size());
  const double dof = std::max(1.0, model.degrees_of_freedom / correlation);
  const double chi = model.chi_squared / correlation / expected;
  if (ChiSquaredBelow(chi, dof) > kMisfitBeyondNoise) {
    model.inflation = std::sqrt(model.chi_squared / model.degrees_of_freedom);
    return model.inflation * TFactor(dof) * std::sqrt(correlation);
  }
  return TFactor(from_points) * std::sqrt(correlation);
}

ValveModel Describe(const FitProblem& problem, const Vector4& p, Matrix4 covariance, ValveModel model,
                    double factor) {
  covariance *= factor * factor;
  const double scale = problem.time_scale();
  const auto with_std = [&](const std::function<double(const Vector4&)>& figure) {
    Vector4 slope;
    for (int i = 0; i < 4; ++i) {
      const double h = 1e-4 * (i == kGain ? std::abs(p(i)) : 1.0);
      Vector4 up = p, down = p;
      up(i) += h;
      down(i) -= h;
      slope(i) = (figure(up) - figure(down)) / (2 * h);
    }
    return ValueWithStd{figure(p), std::sqrt(NonNegative(slope.dot(covariance * slope)))};
  };
  const auto f0 = [](const Vector4& q) { return std::exp(q(kLogOmega)) / kTwoPi; };
  const auto damping = [](const Vector4& q) { return std::exp(q(kLogDamping)); };
  const auto dead_time = [scale](const Vector4& q) { return q(kDeadTime) / scale; };
  model.natural_frequency = with_std(f0);
  model.damping = with_std(damping);
  model.gain = with_std([](const Vector4& q) { return q(kGain); });
  model.dead_time = with_std(dead_time);
  model.bandwidth = with_std([&](const Vector4& q) { return BandwidthOf(f0(q), damping(q)); });
  model.phase_90 = with_std([&](const Vector4& q) { return Phase90Of(f0(q), damping(q), dead_time(q)); });
  model.rise_time_90 =
      with_std([&](const Vector4& q) { return RiseTime90Of(f0(q), damping(q), dead_time(q)); });
  return model;
}

}  // namespace

double FrequencyPoint::GainStd() const { return std::sqrt(variance) * TFactor(dof); }
double FrequencyPoint::PhaseStd() const {
  return std::min(GainStd() / std::max(gain(), 1e-300), std::numbers::pi / std::sqrt(3.0));
}

std::complex<double> ValveModel::Response(double frequency) const {
  Complex sum = 0;
  ForEachImage(kTwoPi * frequency, command_hold, [&](double omega, Complex factor) {
    sum += factor * SecondOrder(omega, kTwoPi * natural_frequency.value, damping.value) *
           std::polar(1.0, -omega * dead_time.value);
  });
  return gain.value * sum;
}

double ValveModel::Phase(double frequency) const {
  const double r = frequency / natural_frequency.value;
  const double without_images = -std::atan2(2 * damping.value * r, 1 - r * r) -
                                kTwoPi * frequency * (dead_time.value + command_hold / 2) -
                                (gain.value < 0 ? std::numbers::pi : 0);
  if (command_hold <= 0) return without_images;
  const double exact = std::arg(Response(frequency));
  return exact + kTwoPi * std::round((without_images - exact) / kTwoPi);
}

void UnwrapPhases(std::vector<FrequencyPoint>& points, const ValveModel* model) {
  double reference = 0;
  for (FrequencyPoint& point : points) {
    if (model) reference = model->Phase(point.frequency);
    const double raw = std::arg(point.response);
    point.phase = raw + kTwoPi * std::round((reference - raw) / kTwoPi);
    if (point.reason == PointReason::kUsed) reference = point.phase;
  }
}

namespace {

Result<ValveModel> Fit(const FitProblem& problem, const Minimum& found, double correlation) {
  Matrix4 covariance;
  if (!std::isfinite(found.cost) || !Covariance(problem, found.p, covariance)) {
    return BadInput(Tell(
        "the {} frequencies from {:.4g} to {:.4g} Hz do not determine f0 and D; sweep up to the frequency at "
        "which the phase passes -90 degrees",
        "die {} Frequenzen von {:.4g} bis {:.4g} Hz bestimmen f0 und D nicht; bis zu der Frequenz messen, bei der die Phase "
        "-90 Grad überschreitet",
        problem.targets().size(), problem.lowest() / kTwoPi, problem.highest() / kTwoPi));
  }
  ValveModel model;
  model.chi_squared = found.cost;
  model.first_order = found.first_order;
  model.degrees_of_freedom = 2 * static_cast<int>(problem.targets().size()) - 4;
  model.lowest = problem.lowest() / kTwoPi;
  model.highest = problem.highest() / kTwoPi;
  const double factor = WidenIntervals(problem, correlation, model);
  return Describe(problem, found.p, covariance, model, factor);
}

}  // namespace

Result<ValveModel> FitValveModel(const std::vector<FrequencyPoint>& points, double correlation,
                                 double sample_period, bool surely_held, const ValveModel* near) {
  const FitProblem continuous(points);
  if (continuous.targets().size() < 3) {
    return BadInput(
        Tell("a model needs at least 3 usable frequencies, there are {}; measure more frequencies",
             "ein Modell braucht mindestens 3 brauchbare Frequenzen, es sind {}; mehr Frequenzen messen",
             continuous.targets().size()));
  }
  const Minimum found = FindMinimum(continuous, near);
  Result<ValveModel> model = Fit(continuous, found, correlation);
  const bool try_hold = sample_period > 0 && model && (surely_held || model->inflation > 1) &&
                        !model->first_order && 2 * model->highest * sample_period < 1;
  if (!try_hold) return model;

  // Half a sample of the delay found is the hold's own.
  const FitProblem held(points, sample_period);
  Minimum search = found;
  search.p(kDeadTime) -= sample_period / 2 * held.time_scale();
  search.cost = Polish(held, search.p);
  const bool better = surely_held ? std::isfinite(search.cost) : search.cost < found.cost / 4;
  if (!better || search.p(kLogDamping) > std::log(kLargestDamping)) return model;
  Result<ValveModel> with_hold = Fit(held, search, correlation);
  if (!with_hold) return model;
  with_hold->command_hold = sample_period;
  return with_hold;
}

}  // namespace hydroscope
