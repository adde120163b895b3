#include "estimation/frequency_response/fit_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/constants.h"
#include "estimation/frequency_response/model.h"
#include "estimation/frequency_response/second_order.h"

namespace hydroscope {
namespace {

using Vector4 = Eigen::Vector4d;

double SquaredMagnitude(Complex z) { return z.real() * z.real() + z.imag() * z.imag(); }

}  // namespace

struct FitProblem::Parameters {
  explicit Parameters(const Vector4& p)
      : omega_0(std::exp(p(kLogOmega))),
        damping(std::exp(p(kLogDamping))),
        gain(p(kGain)),
        scaled_dead_time(p(kDeadTime)) {}
  double omega_0, damping, gain, scaled_dead_time;
};

FitProblem::FitProblem(std::vector<FrequencyPoint> points, double hold) : hold_(hold) {
  std::erase_if(points,
                [](const FrequencyPoint& p) { return p.reason != PointReason::kUsed || !(p.variance > 0); });
  UnwrapPhases(points);
  for (const FrequencyPoint& p : points) {
    targets_.push_back({kTwoPi * p.frequency, p.response, p.phase, p.variance, p.dof});
  }
  if (!targets_.empty()) time_scale_ = targets_.back().omega;
}

FitProblem FitProblem::Thinned(std::size_t most) const {
  if (targets_.size() <= most) return *this;
  const double first = std::log(lowest()), span = std::log(highest()) - first;
  FitProblem thinned(hold_, time_scale_);
  std::size_t step = most;
  for (const Target& target : targets_) {
    const double place = (std::log(target.omega) - first) / span;
    const auto here = std::min(most - 1, static_cast<std::size_t>(static_cast<double>(most) * place));
    if (here != step) {
      thinned.targets_.push_back(target);
      step = here;
    } else if (target.variance < thinned.targets_.back().variance) {
      thinned.targets_.back() = target;
    }
  }
  return thinned;
}

double FitProblem::Cost(const Vector4& p) const {
  double cost = 0;
  const Parameters given(p);
  for (const Target& target : targets_) {
    cost += SquaredMagnitude(target.response - Model(given, target.omega)) / target.variance;
  }
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

void FitProblem::Residuals(const Vector4& p, double* residuals, double* jacobian) const {
  const std::size_t rows = 2 * targets_.size();
  const Parameters given(p);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const Target& target = targets_[i];
    const double weight = 1 / std::sqrt(target.variance);
    std::array<Complex, 4> slope{};
    const Complex model = jacobian ? ModelWithSlopes(given, target.omega, slope) : Model(given, target.omega);
    residuals[2 * i] = weight * (model.real() - target.response.real());
    residuals[2 * i + 1] = weight * (model.imag() - target.response.imag());
    for (std::size_t k = 0; jacobian && k < 4; ++k) {
      jacobian[k * rows + 2 * i] = weight * slope[k].real();
      jacobian[k * rows + 2 * i + 1] = weight * slope[k].imag();
    }
  }
}

Vector4 FitProblem::Complete(double omega_0, double damping) const {
  std::vector<Complex> shapes;
  std::vector<double> phase_left;
  for (const Target& target : targets_) {
    shapes.push_back(SecondOrder(target.omega, omega_0, damping));
    phase_left.push_back(target.phase - std::arg(shapes.back()));
  }
  Vector4 best(std::log(omega_0), std::log(damping), 1, 0);
  double best_projection = -1;
  for (const double polarity : {0.0, std::numbers::pi, -std::numbers::pi}) {
    double ww = 0, wp = 0;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const double omega = targets_[i].omega;
      const double weight = SquaredMagnitude(targets_[i].response) / targets_[i].variance;
      ww += weight * omega * omega;
      wp -= weight * omega * (phase_left[i] - polarity);
    }
    const double dead_time = wp / ww;
    double numerator = 0, denominator = 0;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      const Complex model = Times(shapes[i], std::polar(1.0, -targets_[i].omega * dead_time));
      numerator += Times(std::conj(model), targets_[i].response).real() / targets_[i].variance;
      denominator += SquaredMagnitude(model) / targets_[i].variance;
    }
    // What the projection takes off the weighted squares: the most is the best fit.
    if (const double projection = numerator * numerator / denominator; projection > best_projection) {
      best_projection = projection;
      best(kGain) = numerator / denominator;
      best(kDeadTime) = dead_time * time_scale_;
    }
  }
  return best;
}

Complex FitProblem::Model(const Parameters& p, double omega) const {
  Complex sum = 0;
  ForEachImage(omega, hold_, [&](double image, Complex factor) {
    sum += Times(Times(factor, SecondOrder(image, p.omega_0, p.damping)),
                 std::polar(1.0, -image / time_scale_ * p.scaled_dead_time));
  });
  return p.gain * sum;
}

Complex FitProblem::ModelWithSlopes(const Parameters& p, double frequency,
                                    std::array<Complex, 4>& slope) const {
  Complex model = 0;
  ForEachImage(frequency, hold_, [&](double omega, Complex factor) {
    const double r = omega / p.omega_0;
    const Complex shape = SecondOrder(omega, p.omega_0, p.damping);
    const Complex delayed =
        Times(Times(factor, shape), std::polar(1.0, -omega / time_scale_ * p.scaled_dead_time));
    const Complex term = p.gain * delayed;
    const Complex shaped = Times(term, shape);
    model += term;
    slope[kLogOmega] += Times(shaped, Complex(-2 * r * r, 2 * p.damping * r));
    slope[kLogDamping] -= Times(shaped, Complex(0, 2 * p.damping * r));
    slope[kGain] += delayed;
    slope[kDeadTime] += Times(term, Complex(0, -omega / time_scale_));
  });
  return model;
}

}  // namespace hydroscope
