#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <span>

#include "core/result.h"

namespace hydroscope {

enum class Forgetting {
  kNone,         ///< every equation counts the same for ever
  kExponential,  ///< P / lambda at each update: old data fade, excited or not (winds up at standstill)
  kDirectional,  ///< only the direction of the present regressor fades; needs no persistent excitation
};

enum class UpdateOutcome {
  kUpdated,
  kClipped,       ///< updated with an innovation cut to `clip` standard deviations
  kInDeadZone,    ///< innovation within the noise: nothing changed
  kNoExcitation,  ///< regressor is (nearly) zero: nothing changed
  kNotFinite,     ///< NaN or infinity in the equation, or a regressor beyond 1e50: refused
};

/// Recursive least squares y = u' theta + e, e of unit variance, with the covariance kept as P = U D U' (U unit upper
/// triangular): P stays symmetric and positive whatever the number of updates, where the textbook form ends in NaN.
///
/// Update: Bierman 1976 (measurement update of U D U'). Directional forgetting: SIFt-RLS, Lai and Bernstein 2024
/// (arXiv 2404.10844), for one equation at a time R <- R - (1 - lambda) R u u' R / (u' R u), R = P^-1 (also Cao and
/// Schwartz 2000), which is P <- P + (1 - lambda)/(lambda u' R u) u u', done in U D U' by the rank-one update of Agee
/// and Turner 1972. With one time constant per parameter, lambda of an update is the mean of the parameters' factors
/// weighted by their shares u_i^2 of the regressor, so the forgotten direction is always the excited one.
///
/// Equations are expected in scaled units: regressors of order one, output in noise standard deviations.
class RecursiveLeastSquares {
 public:
  static constexpr int kMaxParameters = 12;

  struct Options {
    Forgetting forgetting = Forgetting::kDirectional;
    double forgetting_factor = 0.998;              ///< lambda, in (0, 1]
    std::array<double, kMaxParameters> factors{};  ///< lambda per parameter; 0 = forgetting_factor
    double initial_covariance = 500.0;             ///< P(0) = this * I
    double max_covariance = 1e12;   ///< nothing is forgotten while a diagonal element of P is beyond
    double min_excitation = 1e-12;  ///< u'u below which an equation says nothing
    double dead_zone = 0.0;         ///< innovations below this many standard deviations are ignored
    double clip = 0.0;              ///< innovations are cut to this many standard deviations; 0 = never
    /// Empty text if usable, else what is wrong: field, value, limit.
    std::string Validate(int parameters) const;
  };

  /// `initial` is theta(0). The options must be valid.
  RecursiveLeastSquares(std::span<const double> initial, const Options& options);

  /// Takes one equation in. `u` has one entry per parameter.
  UpdateOutcome Update(std::span<const double> u, double y) { return update_(*this, u.data(), y); }

  int parameters() const { return n_; }
  Eigen::VectorXd theta() const;
  Eigen::MatrixXd Covariance() const;
  double innovation() const { return innovation_; }  ///< last y - u' theta
  std::int64_t updates() const { return updates_; }
  /// Standard deviation of e relative to the unit the output is scaled by; used by dead zone and clip.
  void set_noise_scale(double scale) { noise_scale_ = scale; }
  double noise_scale() const { return noise_scale_; }

  /// Everything that changes, for saving and restoring.
  struct State {
    std::array<double, kMaxParameters * kMaxParameters> u;
    std::array<double, kMaxParameters> d, theta;
    double noise_scale;
    std::int64_t updates;
  };
  State Save() const;
  void Restore(const State& state);

 private:
  template <int N>
  static UpdateOutcome UpdateFixed(RecursiveLeastSquares& self, const double* u, double y);
  template <int N>
  void Forget(const double* u);
  template <int N>
  double MeasurementUpdate(const double* u, double* gain);

  using UpdateFunction = UpdateOutcome (*)(RecursiveLeastSquares&, const double*, double);
  static UpdateFunction Dispatch(int n);

  Options options_;
  int n_;
  UpdateFunction update_;
  std::array<double, kMaxParameters * kMaxParameters> u_{};  ///< U by columns: u_[j * n + i] = U(i, j), i < j
  std::array<double, kMaxParameters> d_{}, theta_{};
  double noise_scale_ = 1.0, innovation_ = 0.0;
  bool uniform_ = true;
  std::int64_t updates_ = 0;
};

}  // namespace hydroscope
