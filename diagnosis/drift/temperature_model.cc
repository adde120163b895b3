#include "diagnosis/drift/temperature_model.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/non_negative.h"
#include "diagnosis/drift/drift_thresholds.h"
#include "diagnosis/drift/serial.h"
#include "estimation/decompositions.h"

namespace hydroscope::drift {
namespace {

constexpr double kForty = 313.15, kHundred = 373.15;  ///< K
constexpr double kUnitTemperature = 10.0;             ///< K, of the straight and parabolic terms
constexpr int kMostTerms = 3;

/// Std of the slope of a straight line through the points, 1/K; their scatter about it counts if it is larger
/// than their std says.
double StraightSlopeStd(const std::vector<TemperaturePoint>& points) {
  double weight = 0, t = 0, v = 0;
  for (const TemperaturePoint& p : points) {
    const double w = 1 / (p.std * p.std);
    weight += w;
    t += w * p.temperature;
    v += w * p.value;
  }
  t /= weight;
  v /= weight;
  double tt = 0, tv = 0;
  for (const TemperaturePoint& p : points) {
    const double w = 1 / (p.std * p.std);
    tt += w * (p.temperature - t) * (p.temperature - t);
    tv += w * (p.temperature - t) * (p.value - v);
  }
  if (points.size() < 3 || !(tt > 0)) return 0;
  double squares = 0;
  for (const TemperaturePoint& p : points)
    squares += std::pow((p.value - v - tv / tt * (p.temperature - t)) / p.std, 2);
  return std::sqrt(std::max(1.0, squares / static_cast<double>(points.size() - 2)) / tt);
}

}  // namespace

double RelativeViscosity(double temperature, double grade) {
  const double hot =
      6.8 * std::pow(grade / 46.0, 0.57);  // viscosity index about 100 over the ISO grades 32 ... 68
  const auto twice = [](double v) { return std::log10(std::log10(v + 0.7)); };
  const double b = (twice(grade) - twice(hot)) / std::log10(kHundred / kForty);
  const double level = twice(grade) - b * std::log10(temperature / kForty);
  return (std::pow(10, std::pow(10, level)) - 0.7) / grade;
}

Eigen::VectorXd TemperatureModel::Basis(double temperature) const {
  Eigen::VectorXd basis = Eigen::VectorXd::Ones(terms_);
  const double straight = (temperature - centre_) / kUnitTemperature;
  if (terms_ > 1)
    basis[1] = family_ == CurveFamily::kFlow ? RelativeViscosity(temperature) - RelativeViscosity(centre_)
                                             : straight;
  if (terms_ > 2) basis[2] = family_ == CurveFamily::kFlow ? straight : straight * straight;
  return basis;
}

/// Weighted least squares with `terms` terms; returns the sum of squares in units of the points' std.
double TemperatureModel::FitForm(int terms) {
  terms_ = terms;
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(terms);
  for (const TemperaturePoint& p : points_) {
    const Eigen::VectorXd basis = Basis(p.temperature) / p.std;
    h += basis * basis.transpose();
    g += basis * (p.value / p.std);
  }
  covariance_ = SymmetricFactor(h).SolveColumns(Eigen::MatrixXd::Identity(terms, terms));
  coefficients_ = covariance_ * g;
  double squares = 0;
  for (const TemperaturePoint& p : points_)
    squares += std::pow((p.value - Basis(p.temperature).dot(coefficients_)) / p.std, 2);
  const int left = static_cast<int>(points_.size()) - terms;
  if (left > 0) covariance_ *= std::max(1.0, squares / left);
  return squares;
}

Result<TemperatureModel> TemperatureModel::Fit(std::span<const TemperaturePoint> points, CurveFamily family) {
  TemperatureModel model;
  for (const TemperaturePoint& p : points)
    if (!std::isfinite(p.value) || !(p.std > 0) || !std::isfinite(p.std))
      return BadInput("a point of the temperature curve is {} with std {}, expected finite and above 0",
                      p.value, p.std);
  if (points.empty()) return BadInput("a temperature curve needs at least one point");
  model.points_.assign(points.begin(), points.end());
  model.family_ = family;
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(),
                          [](const auto& a, const auto& b) { return a.temperature < b.temperature; });
  model.low_ = low->temperature;
  model.high_ = high->temperature;
  model.centre_ = (model.low_ + model.high_) / 2;
  const bool measured = std::isfinite(model.low_) && std::isfinite(model.high_) &&
                        model.high_ - model.low_ >= kDriftThresholds.least_oil_range;
  const int count = static_cast<int>(points.size());
  const int most = measured ? std::clamp(count - 2, 1, kMostTerms) : 1;
  if (!measured) model.centre_ = std::isfinite(model.centre_) ? model.centre_ : 0;

  std::array<double, kMostTerms> squares{};
  for (int terms = 1; terms <= most; ++terms) {
    squares[terms - 1] = model.FitForm(terms);
    if (terms == 2 && family == CurveFamily::kSmooth)
      model.slope_std_ = std::sqrt(model.covariance_(1, 1)) / kUnitTemperature;
  }
  const double noise = count > most ? std::max(1.0, squares[most - 1] / (count - most)) : 1.0;
  int best = 1;
  const auto criterion = [&](int terms) { return squares[terms - 1] / noise + terms * std::log(count); };
  for (int terms = 2; terms <= most; ++terms)
    if (criterion(terms) < criterion(best)) best = terms;
  model.FitForm(best);
  return model;
}

Result<TemperatureModel> TemperatureModel::FitTerms(std::span<const TemperaturePoint> points,
                                                    CurveFamily family, int terms) {
  auto model = Fit(points, family);
  if (!model) return model;
  const bool measured =
      std::isfinite(model->low_) && model->high_ - model->low_ >= kDriftThresholds.least_oil_range;
  model->FitForm(measured ? std::clamp(static_cast<int>(points.size()) - 2, 1, terms) : 1);
  return model;
}

void TemperatureModel::Adjust(std::vector<TemperaturePoint> points, const Eigen::VectorXd& step,
                              const Eigen::MatrixXd& covariance) {
  points_ = std::move(points);
  coefficients_ += step;
  covariance_ = covariance;
  slope_std_ = StraightSlopeStd(points_);
}

void TemperatureModel::AssumeSlope(double std) { slope_std_ = std; }

TemperatureModel TemperatureModel::Known(double value) {
  TemperatureModel model;
  model.coefficients_[0] = value;
  model.low_ = -std::numeric_limits<double>::infinity();
  model.high_ = std::numeric_limits<double>::infinity();
  return model;
}

TemperatureModel::Prediction TemperatureModel::At(double temperature) const {
  if (terms_ == 1 && !(slope_std_ > 0)) temperature = std::isfinite(low_) ? low_ : 0;
  if (!std::isfinite(temperature)) temperature = centre_;
  const double inside = std::clamp(temperature, low_, high_);
  const Eigen::VectorXd basis = Basis(inside);
  Prediction prediction{basis.dot(coefficients_), std::sqrt(NonNegative(basis.dot(covariance_ * basis))),
                        false};
  if (inside == temperature) return prediction;
  const double step = 0.5, inward = inside == low_ ? step : -step;
  const double slope = (Basis(inside + inward).dot(coefficients_) - prediction.value) / inward;
  const double distance = temperature - inside;
  return {prediction.value + slope * distance,
          std::hypot(prediction.std, distance * std::max(std::abs(slope), slope_std_)), true};
}

std::string TemperatureModel::FormName() const {
  static const char* const kNames[2][kMostTerms] = {{"constant", "viscosity", "viscosity + straight"},
                                                    {"constant", "straight", "parabola"}};
  return kNames[family_ == CurveFamily::kFlow ? 0 : 1][terms_ - 1];
}

void TemperatureModel::Save(ByteWriter& out) const {
  out.Put<std::uint8_t>(family_ == CurveFamily::kFlow ? 1 : 0);
  for (const double v : {centre_, low_, high_, slope_std_}) out.Put(v);
  PutVector(out, coefficients_);
  PutVector(out, covariance_.reshaped());
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(points_.size()));
  for (const TemperaturePoint& p : points_) out.Put(p);
}

bool TemperatureModel::Restore(ByteReader& in) {
  family_ = in.Get<std::uint8_t>() == 1 ? CurveFamily::kFlow : CurveFamily::kSmooth;
  for (double* v : {&centre_, &low_, &high_, &slope_std_}) *v = in.Get<double>();
  coefficients_ = GetVector(in, kMostTerms);
  const Eigen::VectorXd packed = GetVector(in, kMostTerms * kMostTerms);
  terms_ = static_cast<int>(coefficients_.size());
  if (!in.ok() || terms_ < 1 || packed.size() != terms_ * terms_) return false;
  covariance_ = packed.reshaped(terms_, terms_);
  points_.clear();
  for (auto left = in.Get<std::uint32_t>(); left > 0 && in.ok(); --left)
    points_.push_back(in.Get<TemperaturePoint>());
  return in.ok();
}

}  // namespace hydroscope::drift
