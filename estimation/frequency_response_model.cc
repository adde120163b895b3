#include "estimation/frequency_response_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/constants.h"
#include "core/non_negative.h"
#include "estimation/frequency_response_figures.h"

namespace hydroscope {
namespace {

using Complex = std::complex<double>;
using Vector4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;

// Above, the second pole lies a hundred times above the first: the response is of first order for any sweep.
constexpr double kLargestDamping = 5;

/// Parameters of the search: log of w0, log of D, K_v, T_dead times `time_scale`.
enum { kLogOmega, kLogDamping, kGain, kDeadTime };

double TFactor(double dof) {
  if (!(dof < 1e6)) return 1;
  return boost::math::quantile(boost::math::students_t(std::max(dof, 1.0)), 0.975) / kNormal95;
}

Complex SecondOrder(double omega, double omega_0, double damping) {
  const double r = omega / omega_0;
  return 1.0 / Complex(1 - r * r, 2 * damping * r);
}

/// Calls visit(w_m, factor_m) for the terms whose sum is the response between samples: the frequency itself,
/// or for a command held from sample to sample also its images w_m = w + m 2 pi / hold, each through the hold
/// (1 - exp(-j w_m hold)) / (j w_m hold) (Astroem and Wittenmark, Computer-Controlled Systems, 1997,
/// sec. 7.6).
template <typename Visit>
void ForEachImage(double omega, double hold, Visit visit) {
  if (hold <= 0) {
    visit(omega, Complex(1));
    return;
  }
  constexpr int kImages = 16;
  const Complex numerator = 1.0 - std::polar(1.0, -omega * hold);
  for (int m = -kImages; m <= kImages; ++m) {
    const double image = omega + m * kTwoPi / hold;
    visit(image, numerator / Complex(0, image * hold));
  }
}

class Problem {
 public:
  explicit Problem(const std::vector<FrequencyPoint>& points, double hold = 0) : hold_(hold) {
    for (const FrequencyPoint& point : points) {
      if (point.reason == PointReason::kUsed && point.variance > 0) points_.push_back(point);
    }
    UnwrapPhases(points_);
    if (!points_.empty()) time_scale_ = kTwoPi * points_.back().frequency;
  }

  const std::vector<FrequencyPoint>& points() const { return points_; }
  double time_scale() const { return time_scale_; }

  double Cost(const Vector4& p) const {
    double cost = 0;
    for (const FrequencyPoint& point : points_) {
      cost += std::norm(point.response - Model(p, kTwoPi * point.frequency)) / point.variance;
    }
    return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
  }

  /// Normal matrix J'J and gradient J'r of the weighted residuals.
  void Linearise(const Vector4& p, Matrix4& normal, Vector4& gradient) const {
    normal.setZero();
    gradient.setZero();
    const double omega_0 = std::exp(p(kLogOmega)), damping = std::exp(p(kLogDamping));
    for (const FrequencyPoint& point : points_) {
      Complex model = 0;
      Eigen::Vector4cd slope = Eigen::Vector4cd::Zero();
      ForEachImage(kTwoPi * point.frequency, hold_, [&](double omega, Complex factor) {
        const double r = omega / omega_0;
        const Complex shape = SecondOrder(omega, omega_0, damping);
        const Complex delayed = factor * shape * std::polar(1.0, -omega / time_scale_ * p(kDeadTime));
        const Complex term = p(kGain) * delayed;
        model += term;
        slope(kLogOmega) += term * shape * Complex(-2 * r * r, 2 * damping * r);
        slope(kLogDamping) -= term * shape * Complex(0, 2 * damping * r);
        slope(kGain) += delayed;
        slope(kDeadTime) += term * Complex(0, -omega / time_scale_);
      });
      const Complex residual = point.response - model;
      normal += (slope.conjugate() * slope.transpose()).real() / point.variance;
      gradient += (slope.conjugate() * residual).real() / point.variance;
    }
  }

  /// Best dead time and gain for given f0 and D: the phase left over is a line through the origin (or through
  /// +-pi if the polarity is reversed), the gain a projection.
  Vector4 Complete(double omega_0, double damping) const {
    Vector4 best(std::log(omega_0), std::log(damping), 1, 0);
    double best_cost = std::numeric_limits<double>::infinity();
    for (const double polarity : {0.0, std::numbers::pi, -std::numbers::pi}) {
      double ww = 0, wp = 0;
      for (const FrequencyPoint& point : points_) {
        const double omega = kTwoPi * point.frequency, weight = std::norm(point.response) / point.variance;
        const double r = omega / omega_0;
        const double left = point.phase + std::atan2(2 * damping * r, 1 - r * r) - polarity;
        ww += weight * omega * omega;
        wp -= weight * omega * left;
      }
      Vector4 p = best;
      p(kGain) = 1;
      p(kDeadTime) = wp / ww * time_scale_;
      double numerator = 0, denominator = 0;
      for (const FrequencyPoint& point : points_) {
        const Complex model = Model(p, kTwoPi * point.frequency);
        numerator += (std::conj(model) * point.response).real() / point.variance;
        denominator += std::norm(model) / point.variance;
      }
      p(kGain) = numerator / denominator;
      if (const double cost = Cost(p); cost < best_cost) {
        best_cost = cost;
        best = p;
      }
    }
    return best;
  }

 private:
  Complex Model(const Vector4& p, double omega) const {
    const double omega_0 = std::exp(p(kLogOmega)), damping = std::exp(p(kLogDamping));
    Complex sum = 0;
    ForEachImage(omega, hold_, [&](double image, Complex factor) {
      sum += factor * SecondOrder(image, omega_0, damping) *
             std::polar(1.0, -image / time_scale_ * p(kDeadTime));
    });
    return p(kGain) * sum;
  }

  double hold_;
  std::vector<FrequencyPoint> points_;
  double time_scale_ = 1;
};

/// The paper's linear equation of the squared gain, weighted; false if it has no physical solution.
bool SquaredGainStart(const Problem& problem, double& omega_0, double& damping) {
  const double scale = problem.time_scale();  // keeps the columns of one size
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const FrequencyPoint& point : problem.points()) {
    const double squared = std::norm(point.response), w = kTwoPi * point.frequency / scale;
    const Eigen::Vector3d row(w * w * squared, -w * w * w * w * squared, 1);
    const double weight = 1 / (4 * squared * point.variance);
    normal += weight * row * row.transpose();
    right += weight * squared * row;
  }
  const Eigen::Vector3d theta = normal.ldlt().solve(right);
  if (!(theta(1) > 0) || !(theta(2) > 0)) return false;
  omega_0 = scale / std::pow(theta(1), 0.25);
  const double damping_squared = (2 - theta(0) / std::sqrt(theta(1))) / 4;
  damping = std::sqrt(std::max(damping_squared, 1e-4));
  return std::isfinite(omega_0);
}

/// The few best starting points, best first.
std::vector<Vector4> Starts(const Problem& problem) {
  std::vector<std::pair<double, Vector4>> candidates;
  const auto add = [&](double omega_0, double damping) {
    const Vector4 p = problem.Complete(omega_0, damping);
    candidates.emplace_back(problem.Cost(p), p);
  };
  const double lowest = kTwoPi * problem.points().front().frequency / 2;
  const double highest = kTwoPi * problem.points().back().frequency * 6;
  for (double omega_0 = lowest; omega_0 <= highest; omega_0 *= 1.3) {
    for (const double damping : {0.1, 0.2, 0.4, 0.7, 1.0, 1.6, 3.0}) add(omega_0, damping);
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vector4> starts;
  double omega_0 = 0, damping = 0;
  if (SquaredGainStart(problem, omega_0, damping)) starts.push_back(problem.Complete(omega_0, damping));
  for (std::size_t i = 0; i < candidates.size() && starts.size() < 5; ++i)
    starts.push_back(candidates[i].second);
  return starts;
}

/// Levenberg-Marquardt with Marquardt's scaling of the diagonal.
double Polish(const Problem& problem, Vector4& p, bool damping_fixed = false) {
  double cost = problem.Cost(p), damping = 1e-3;
  for (int iteration = 0; iteration < 200; ++iteration) {
    Matrix4 normal;
    Vector4 gradient;
    problem.Linearise(p, normal, gradient);
    if (damping_fixed) {
      normal.row(kLogDamping).setZero();
      normal.col(kLogDamping).setZero();
      normal(kLogDamping, kLogDamping) = 1;
      gradient(kLogDamping) = 0;
    }
    bool improved = false;
    double gained = 0;
    while (!improved && damping < 1e12) {
      Matrix4 damped = normal;
      damped.diagonal() += damping * normal.diagonal();
      const Vector4 next = p + damped.ldlt().solve(gradient);
      const double next_cost = problem.Cost(next);
      improved = next_cost < cost;
      if (improved) {
        gained = cost - next_cost;
        p = next;
        cost = next_cost;
        damping = std::max(damping / 10, 1e-12);
      } else {
        damping *= 10;
      }
    }
    if (!improved || gained < 1e-10 * (cost + 1e-12)) break;
  }
  return cost;
}

struct Minimum {
  Vector4 p = Vector4::Zero();
  double cost = std::numeric_limits<double>::infinity();
  bool first_order = false;  ///< damping ran to its limit
};

Minimum FindMinimum(const Problem& problem) {
  Minimum best;
  for (Vector4 p : Starts(problem)) {
    const double cost = Polish(problem, p);
    if (cost < best.cost) best = {p, cost, false};
  }
  if (best.p(kLogDamping) > std::log(kLargestDamping)) {
    // Beyond, f0 and D only matter as f0/(2 D): hold D and let the rest settle.
    const double corner = std::exp(best.p(kLogOmega) - best.p(kLogDamping)) / 2;
    Vector4 p = problem.Complete(2 * kLargestDamping * corner, kLargestDamping);
    best.cost = Polish(problem, p, true);
    best.p = p;
    best.first_order = true;
  }
  return best;
}

/// Inverse of the normal matrix; false if a combination of the parameters has no effect at all.
bool Covariance(const Problem& problem, const Vector4& p, Matrix4& covariance) {
  Matrix4 normal;
  Vector4 gradient;
  problem.Linearise(p, normal, gradient);
  const Vector4 scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix4 scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  if (!scaled.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix4> eigen(scaled);
  if (!(eigen.eigenvalues()(0) > 1e-12)) return false;
  covariance = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  return true;
}

/// Factor on every std: misfit beyond the noise, and Student's t where degrees of freedom are few.
double WidenIntervals(const Problem& problem, double correlation, ValveModel& model) {
  double from_points = 0, expected = 0;
  for (const FrequencyPoint& point : problem.points()) {
    from_points += std::min(point.dof, 1e6);
    expected += point.dof > 4 ? point.dof / (point.dof - 2) : 2;
  }
  expected /= static_cast<double>(problem.points().size());
  const double dof = std::max(1.0, model.degrees_of_freedom / correlation);
  const double chi = model.chi_squared / correlation / expected;
  if (boost::math::cdf(boost::math::chi_squared(dof), chi) > 0.95) {
    model.inflation = std::sqrt(model.chi_squared / model.degrees_of_freedom);
    return model.inflation * TFactor(dof) * std::sqrt(correlation);
  }
  return TFactor(from_points) * std::sqrt(correlation);
}

ValveModel Describe(const Problem& problem, const Vector4& p, Matrix4 covariance, ValveModel model,
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

Result<ValveModel> Fit(const Problem& problem, const Minimum& found, double correlation) {
  const auto& points = problem.points();
  Matrix4 covariance;
  if (!std::isfinite(found.cost) || !Covariance(problem, found.p, covariance)) {
    return BadInput(
        "the {} frequencies from {:.4g} to {:.4g} Hz do not determine f0 and D; sweep up to the frequency at "
        "which the "
        "phase passes -90 degrees",
        points.size(), points.front().frequency, points.back().frequency);
  }
  ValveModel model;
  model.chi_squared = found.cost;
  model.first_order = found.first_order;
  model.degrees_of_freedom = 2 * static_cast<int>(points.size()) - 4;
  model.lowest = points.front().frequency;
  model.highest = points.back().frequency;
  const double factor = WidenIntervals(problem, correlation, model);
  return Describe(problem, found.p, covariance, model, factor);
}

}  // namespace

Result<ValveModel> FitValveModel(const std::vector<FrequencyPoint>& points, double correlation,
                                 double sample_period, bool surely_held) {
  const Problem continuous(points);
  if (continuous.points().size() < 3) {
    return BadInput("a model needs at least 3 usable frequencies, there are {}; measure more frequencies",
                    continuous.points().size());
  }
  const Minimum found = FindMinimum(continuous);
  Result<ValveModel> model = Fit(continuous, found, correlation);
  const bool try_hold = sample_period > 0 && model && (surely_held || model->inflation > 1) &&
                        !model->first_order && 2 * model->highest * sample_period < 1;
  if (!try_hold) return model;

  // Half a sample of the delay found is the hold's own.
  const Problem held(points, sample_period);
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
