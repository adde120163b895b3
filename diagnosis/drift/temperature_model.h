#pragma once

#include <Eigen/Dense>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/bytes.h"
#include "core/result.h"
#include "diagnosis/drift/drift_thresholds.h"

namespace hydroscope::drift {

/// Kinematic viscosity of a mineral oil over its viscosity at 40 degC, by Walther's law log log(v + 0.7) = a
/// - b log T (ASTM D341, v in mm^2/s, T in K) through `grade` mm^2/s at 40 degC and a viscosity index near
/// 100 (ISO VG 46: 6.8 mm^2/s at 100 degC).
double RelativeViscosity(double temperature, double grade = 46.0);

/// One temperature's worth of commissioning strokes: what a parameter was there.
struct TemperaturePoint {
  double temperature = 0;  ///< K
  double value = 0;        ///< SI
  double std = 0;          ///< SI, sampling error only
};

/// What the dependence may look like.
enum class CurveFamily {
  kFlow,    ///< constant; a + b v(T); a + b v(T) + c T, with the relative viscosity v
  kSmooth,  ///< constant; straight; parabola
};

/// A parameter over oil temperature as learned in commissioning, with its uncertainty. Of the family's forms
/// the one with the lowest Bayesian information criterion (Schwarz 1978) is taken; scatter of the points
/// about it beyond their std widens the uncertainty. Outside the range seen the curve goes on straight with
/// the slope it had at the edge, and that whole slope, or the uncertainty of a straight line's slope,
/// whichever is larger, counts as uncertainty.
class TemperatureModel {
 public:
  struct Prediction {
    double value = 0;
    double std = 0;
    bool outside = false;  ///< beyond the range seen
  };

  TemperatureModel() = default;
  /// Needs one point at least, finite, with std > 0. Points without temperature (NaN) give a constant.
  static Result<TemperatureModel> Fit(std::span<const TemperaturePoint> points, CurveFamily family);
  /// The same with a given form; its coefficients are then adjusted together with those of other curves.
  static Result<TemperatureModel> FitTerms(std::span<const TemperaturePoint> points, CurveFamily family,
                                           int terms);
  /// Values of the form's terms at a temperature inside the range.
  Eigen::VectorXd Basis(double temperature) const;
  /// Takes over points, adds to the coefficients and states their covariance.
  void Adjust(std::vector<TemperaturePoint> points, const Eigen::VectorXd& step,
              const Eigen::MatrixXd& covariance);
  /// Where the points span too few kelvin to tell a slope: what it may be outside them, SI/K.
  void AssumeSlope(double std);
  bool tells_slope() const { return points_.size() >= 3 && high_ - low_ >= kDriftThresholds.least_oil_range; }
  /// A value that is known beforehand (no leakage).
  static TemperatureModel Known(double value);

  Prediction At(double temperature) const;
  /// "constant", "viscosity", "viscosity + straight", "straight" or "parabola".
  std::string FormName() const;
  double low() const { return low_; }    ///< K, coldest point
  double high() const { return high_; }  ///< K, warmest point
  const std::vector<TemperaturePoint>& points() const { return points_; }

  void Save(ByteWriter& out) const;
  /// False if the bytes are damaged; the model is then undefined.
  bool Restore(ByteReader& in);

 private:
  double FitForm(int terms);

  CurveFamily family_ = CurveFamily::kSmooth;
  int terms_ = 1;
  double centre_ = 0, low_ = 0, high_ = 0;
  double slope_std_ = 0;  ///< of a straight line through the points
  Eigen::VectorXd coefficients_ = Eigen::VectorXd::Zero(1);
  Eigen::MatrixXd covariance_ = Eigen::MatrixXd::Zero(1, 1);
  std::vector<TemperaturePoint> points_;
};

}  // namespace hydroscope::drift
