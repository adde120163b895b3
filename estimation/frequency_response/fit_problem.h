#pragma once

#include <Eigen/Dense>
#include <array>
#include <complex>
#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {

/// Parameters of the search for a valve model: log of w0, log of D, K_v, T_dead times `time_scale`.
enum { kLogOmega, kLogDamping, kGain, kDeadTime };

/// What the fit needs of a measured point.
struct Target {
  double omega = 0;  // rad/s
  std::complex<double> response;
  double phase = 0;     // rad, unwrapped
  double variance = 0;  // of real and of imaginary part
  double dof = 1;
};

/// Points to be fitted and the model of their response at given parameters.
class FitProblem {
 public:
  /// Of the points marked kUsed. `hold`: s for which the command is held from sample to sample, 0 = not.
  explicit FitProblem(std::vector<FrequencyPoint> points, double hold = 0);

  /// The same with fewer points: of each of `most` equal steps of log frequency the one known best.
  FitProblem Thinned(std::size_t most) const;

  const std::vector<Target>& targets() const { return targets_; }
  double lowest() const { return targets_.front().omega; }
  double highest() const { return targets_.back().omega; }
  double time_scale() const { return time_scale_; }

  /// Weighted sum of squares of the misfit.
  double Cost(const Eigen::Vector4d& p) const;

  /// Misfit of real and imaginary part of each point over its standard deviation, and its slopes to the four
  /// parameters, `jacobian` column by column (may be null).
  void Residuals(const Eigen::Vector4d& p, double* residuals, double* jacobian) const;

  /// Best dead time and gain for given f0 and D: the phase left over is a line through the origin (or through
  /// +-pi if the polarity is reversed), the gain a projection.
  Eigen::Vector4d Complete(double omega_0, double damping) const;

 private:
  struct Parameters;

  FitProblem(double hold, double time_scale) : hold_(hold), time_scale_(time_scale) {}
  std::complex<double> Model(const Parameters& p, double omega) const;
  std::complex<double> ModelWithSlopes(const Parameters& p, double omega,
                                       std::array<std::complex<double>, 4>& slope) const;

  double hold_;
  std::vector<Target> targets_;
  double time_scale_ = 1;
};

}  // namespace hydroscope
