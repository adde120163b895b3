#include "estimation/frequency_response/fit_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/constants.h"
#include "core/parallel/wide.h"
#include "estimation/frequency_response/model.h"
#include "estimation/frequency_response/second_order.h"

namespace hydroscope {
namespace {

using Vector4 = Eigen::Vector4d;

double SquaredMagnitude(Complex z) { return z.real() * z.real() + z.imag() * z.imag(); }

}  // namespace

/// Images of a frequency that a held command has, as ForEachImage visits them; a command that moves evenly has the frequency alone.
constexpr int kTermsOfHold = 2 * kImages + 1;
using PerImage = std::array<double, kTermsOfHold>;

/// PerImage of the response without what FactorOf gives, and times what makes them slopes to log w0, log D and dead time.
struct ResponseTerms {
  PerImage real, imag, omega_real, omega_imag, damping_real, damping_imag, delay_real, delay_imag;
};

/// Numbers of a model that all frequencies share.
struct FitProblem::Parameters {
  Parameters(const Vector4& p, double time_scale, double hold)
      : omega_0(std::exp(p(kLogOmega))),
        damping(std::exp(p(kLogDamping))),
        gain(p(kGain)),
        dead_time(p(kDeadTime) / time_scale),
        hold(hold),
        count(hold > 0 ? kTermsOfHold : 1),
        apart(hold > 0 ? kTwoPi / hold : 0.0),
        first(-(count / 2) * apart) {
    for (int m = 0; m < count; ++m) {
      const Complex turned = std::polar(1.0, -m * apart * dead_time);
      turn_real[m] = turned.real();
      turn_imag[m] = turned.imag();
    }
  }
  HYDROSCOPE_WIDE void FillTerms(const Parameters& p, double omega, bool with_slopes, ResponseTerms& t) {
    const double per_omega_0 = 1 / p.omega_0, twice_damping = 2 * p.damping, from = omega + p.first;
    for (int m = 0; m < p.count; ++m) {
      const double w = from + m * p.apart, r = w * per_omega_0;
      const double a = 1 - r * r, b = twice_damping * r,
                   over = 1 / ((a * a + b * b) * (p.hold > 0 ? w : 1.0));
      t.real[m] = over * (a * p.turn_real[m] + b * p.turn_imag[m]);
      t.imag[m] = over * (a * p.turn_imag[m] - b * p.turn_real[m]);
    }
    for (int m = 0; with_slopes && m < p.count; ++m) {
      const double w = from + m * p.apart, r = w * per_omega_0;
      const double a = 1 - r * r, b = twice_damping * r, over = 1 / (a * a + b * b);
      const double real = over * (t.real[m] * a + t.imag[m] * b),
                   imag = over * (t.imag[m] * a - t.real[m] * b);
      t.omega_real[m] = -2 * r * r * real - b * imag;
      t.omega_imag[m] = b * real - 2 * r * r * imag;
      t.damping_real[m] = b * imag;
      t.damping_imag[m] = -b * real;
      t.delay_real[m] = w * t.imag[m];
      t.delay_imag[m] = -w * t.real[m];
    }
  }
  /// What all terms of a frequency have as a factor, but for the gain: dead time of the first image, hold.
  Complex FactorOf(double omega) const {
    const Complex delayed = std::polar(1.0, -(omega + first) * dead_time);
    return hold > 0 ? Times(delayed, Times(1.0 - std::polar(1.0, -omega * hold), Complex(0, -1 / hold)))
                    : delayed;
  }

  double omega_0, damping, gain, dead_time;
  double hold;                    ///< s, 0: the command moves evenly
  int count;                      ///< terms
  double apart;                   ///< rad/s from image to image
  double first;                   ///< rad/s from a frequency to its first image
  PerImage turn_real, turn_imag;  ///< exp(-j w T) of an image over that of the first one
};

namespace {

Complex Sum(const PerImage& real, const PerImage& imag, int count) {
  Complex sum = 0;
  for (int m = 0; m < count; ++m) sum += Complex(real[m], imag[m]);
  return sum;
}

}  // namespace

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
  const Parameters given(p, time_scale_, hold_);
  for (const Target& target : targets_) {
    cost += SquaredMagnitude(target.response - Model(given, target.omega)) / target.variance;
  }
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

void FitProblem::Residuals(const Vector4& p, double* residuals, double* jacobian) const {
  const std::size_t rows = 2 * targets_.size();
  const Parameters given(p, time_scale_, hold_);
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
  ResponseTerms terms;
  Parameters::FillTerms(p, omega, false, terms);
  return p.gain * Times(p.FactorOf(omega), Sum(terms.real, terms.imag, p.count));
}

Complex FitProblem::ModelWithSlopes(const Parameters& p, double omega, std::array<Complex, 4>& slope) const {
  ResponseTerms terms;
  Parameters::FillTerms(p, omega, true, terms);
  const Complex factor = p.FactorOf(omega), with_gain = p.gain * factor;
  slope[kLogOmega] = Times(with_gain, Sum(terms.omega_real, terms.omega_imag, p.count));
  slope[kLogDamping] = Times(with_gain, Sum(terms.damping_real, terms.damping_imag, p.count));
  slope[kGain] = Times(factor, Sum(terms.real, terms.imag, p.count));
  slope[kDeadTime] = Times(with_gain, Sum(terms.delay_real, terms.delay_imag, p.count)) / time_scale_;
  return p.gain * slope[kGain];
}

}  // namespace hydroscope
