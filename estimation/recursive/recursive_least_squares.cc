#include "estimation/recursive/recursive_least_squares.h"

#include <algorithm>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kMaxEnergy = 1e100;  ///< u'u beyond which u' P u could overflow; regressors are of order one

}  // namespace

std::string RecursiveLeastSquares::Options::Validate(int parameters) const {
  if (parameters < 1 || parameters > kMaxParameters)
    return fmt::format("{} parameters, expected 1 to {}", parameters, kMaxParameters);
  if (!(forgetting_factor > 0 && forgetting_factor <= 1))
    return fmt::format("forgetting_factor is {}, expected above 0 and at most 1", forgetting_factor);
  for (int i = 0; i < parameters; ++i)
    if (!(factors[i] >= 0 && factors[i] <= 1))
      return fmt::format("factors[{}] is {}, expected 0 to 1", i, factors[i]);
  if (!(initial_covariance > 0))
    return fmt::format("initial_covariance is {}, expected above 0", initial_covariance);
  if (!(max_covariance >= initial_covariance))
    return fmt::format("max_covariance is {}, expected at least initial_covariance {}", max_covariance,
                       initial_covariance);
  if (!(dead_zone >= 0)) return fmt::format("dead_zone is {}, expected 0 or more", dead_zone);
  if (!(clip >= 0)) return fmt::format("clip is {}, expected 0 or more", clip);
  return "";
}

RecursiveLeastSquares::RecursiveLeastSquares(std::span<const double> initial, const Options& options)
    : options_(options), n_(static_cast<int>(initial.size())), update_(Dispatch(n_)) {
  std::ranges::copy(initial, theta_.begin());
  for (int i = 0; i < n_; ++i) {
    d_[i] = options.initial_covariance;
    u_[i * n_ + i] = 1.0;
    if (options_.factors[i] == 0.0) options_.factors[i] = options.forgetting_factor;
    uniform_ = uniform_ && options_.factors[i] == options_.factors[0];
  }
}

Eigen::VectorXd RecursiveLeastSquares::theta() const {
  return Eigen::Map<const Eigen::VectorXd>(theta_.data(), n_);
}

Eigen::MatrixXd RecursiveLeastSquares::Covariance() const {
  const Eigen::Map<const Eigen::MatrixXd> u(u_.data(), n_, n_);
  const Eigen::Map<const Eigen::VectorXd> d(d_.data(), n_);
  const Eigen::MatrixXd p = u * d.asDiagonal() * u.transpose();
  return p.selfadjointView<Eigen::Upper>();
}

RecursiveLeastSquares::State RecursiveLeastSquares::Save() const {
  return {u_, d_, theta_, noise_scale_, updates_};
}

void RecursiveLeastSquares::Restore(const State& state) {
  u_ = state.u;
  d_ = state.d;
  theta_ = state.theta;
  noise_scale_ = state.noise_scale;
  updates_ = state.updates;
}

template <int N>
void RecursiveLeastSquares::Forget(const double* u) {
  double lambda = options_.factors[0];
  if (!uniform_) {
    double weighted = 0, total = 0;
    for (int i = 0; i < N; ++i) {
      weighted += options_.factors[i] * u[i] * u[i];
      total += u[i] * u[i];
    }
    lambda = weighted / total;
  }
  if (lambda == 1.0 || options_.forgetting == Forgetting::kNone) return;
  for (int i = 0; i < N; ++i) {
    double variance = d_[i];
    for (int j = i + 1; j < N; ++j) variance += u_[j * N + i] * u_[j * N + i] * d_[j];
    if (variance > options_.max_covariance) return;
  }
  if (options_.forgetting == Forgetting::kExponential) {
    const double inverse = 1.0 / lambda;
    for (int i = 0; i < N; ++i) d_[i] *= inverse;
    return;
  }
  // a = U^-1 u; information of the direction u' R u = sum a_j^2 / d_j. What does not depend on a is divided beforehand.
  std::array<double, N> a, inverse_d, information;  // information: of entries j and above
  for (int j = 0; j < N; ++j) inverse_d[j] = 1.0 / d_[j];
  const double kept = lambda / (1.0 - lambda);
  std::copy(u, u + N, a.begin());
  for (int j = N - 1; j > 0; --j)
    for (int i = 0; i < j; ++i) a[i] -= a[j] * u_[j * N + i];
  double total = 0;
  for (int j = N - 1; j >= 0; --j) {
    total += a[j] * a[j] * inverse_d[j];
    information[j] = total;
  }
  // P + c u u' with c = (1 - lambda) / (lambda total). The running 1/c of Agee-Turner is a prefix sum, so no
  // division waits for another.
  const double start = kept * total;
  double inverse_before = 1.0 / start;
  std::array<double, N> v;
  std::copy(u, u + N, v.begin());
  for (int j = N - 1; j >= 0; --j) {
    const double after = start + information[j], inverse_after = 1.0 / after;
    const double b = a[j] * inverse_d[j] * inverse_after;
    d_[j] *= after * inverse_before;
    for (int i = 0; i < j; ++i) {
      v[i] -= a[j] * u_[j * N + i];
      u_[j * N + i] += b * v[i];
    }
    inverse_before = inverse_after;
  }
}

template <int N>
double RecursiveLeastSquares::MeasurementUpdate(const double* u, double* gain) {
  std::array<double, N> f, g;
  for (int j = 0; j < N; ++j) {
    f[j] = u[j];
    for (int i = 0; i < j; ++i) f[j] += u_[j * N + i] * u[i];
    g[j] = d_[j] * f[j];
  }
  double before = 1.0, inverse = 1.0;
  for (int j = 0; j < N; ++j) {
    const double after = before + f[j] * g[j], inverse_after = 1.0 / after;
    const double factor = -f[j] * inverse;
    d_[j] *= before * inverse_after;
    gain[j] = g[j];
    for (int i = 0; i < j; ++i) {
      const double old = u_[j * N + i];
      u_[j * N + i] = old + gain[i] * factor;
      gain[i] += g[j] * old;
    }
    before = after;
    inverse = inverse_after;
  }
  for (int i = 0; i < N; ++i) gain[i] *= inverse;
  return before;
}

template <int N>
UpdateOutcome RecursiveLeastSquares::UpdateFixed(RecursiveLeastSquares& self, const double* u, double y) {
  double energy = 0, prediction = 0;
  for (int i = 0; i < N; ++i) {
    energy += u[i] * u[i];
    prediction += u[i] * self.theta_[i];
  }
  double innovation = y - prediction;
  if (!(energy < kMaxEnergy) || !std::isfinite(innovation)) return UpdateOutcome::kNotFinite;
  self.innovation_ = innovation;
  if (energy < self.options_.min_excitation) return UpdateOutcome::kNoExcitation;
  if (std::abs(innovation) < self.options_.dead_zone * self.noise_scale_) return UpdateOutcome::kInDeadZone;
  self.Forget<N>(u);
  std::array<double, N> gain;
  const double innovation_variance = self.MeasurementUpdate<N>(u, gain.data());
  UpdateOutcome outcome = UpdateOutcome::kUpdated;
  if (self.options_.clip > 0) {
    const double limit = self.options_.clip * self.noise_scale_ * std::sqrt(innovation_variance);
    if (std::abs(innovation) > limit) {
      innovation = std::copysign(limit, innovation);
      outcome = UpdateOutcome::kClipped;
    }
  }
  for (int i = 0; i < N; ++i) self.theta_[i] += gain[i] * innovation;
  ++self.updates_;
  return outcome;
}

RecursiveLeastSquares::UpdateFunction RecursiveLeastSquares::Dispatch(int n) {
  constexpr std::array<UpdateFunction, kMaxParameters> table = {
      &UpdateFixed<1>, &UpdateFixed<2>,  &UpdateFixed<3>,  &UpdateFixed<4>,
      &UpdateFixed<5>, &UpdateFixed<6>,  &UpdateFixed<7>,  &UpdateFixed<8>,
      &UpdateFixed<9>, &UpdateFixed<10>, &UpdateFixed<11>, &UpdateFixed<12>};
  return table[std::clamp(n, 1, kMaxParameters) - 1];
}

}  // namespace hydroscope
