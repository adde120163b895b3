#include "estimation/published_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/non_negative.h"
#include "machines/die_cushion/balance.h"

namespace hydroscope {
namespace {

/// Scales that bring the SI regression to order one ("theta_i(0) = 1, alpha = 500" makes sense only there):
/// typical opening 0.2, pressure 100 bar, pressure rate 1000 bar/s, position 0.1 m, flow 60 l/min.
constexpr double kOutputScale = 1e-3;
constexpr std::array<double, 4> kRegressorScale = {0.2 * 3162.0, 1e8, 1e7, 3162.0};

RecursiveLeastSquares MakeRls(const EstimatorSpec& spec) {
  RecursiveLeastSquares::Options options;
  options.forgetting =
      spec.form == EstimatorForm::kDirectional ? Forgetting::kDirectional : Forgetting::kExponential;
  options.forgetting_factor = spec.form == EstimatorForm::kDirectional
                                  ? std::exp(-spec.update_period / spec.time_constant)
                                  : spec.forgetting_factor;
  options.initial_covariance = spec.initial_covariance;
  options.max_covariance = std::max(spec.max_covariance, spec.initial_covariance);
  options.dead_zone = spec.dead_zone;
  const std::array<double, 4> initial = {spec.initial_parameter, spec.initial_parameter,
                                         spec.initial_parameter, spec.initial_parameter};
  return RecursiveLeastSquares(initial, options);
}

}  // namespace

PublishedGeometry PublishedGeometry::From(const Machine& machine) {
  return {machine.Geometry("A_A").value_or(KnownValue{}).value,
          machine.Geometry("p_t").value_or(KnownValue{}).value};
}

PublishedEstimator::PublishedEstimator(const EstimatorSpec& spec, std::shared_ptr<const ModelStructure> model,
                                       const PublishedGeometry& geometry, double period)
    : spec_(spec),
      model_(std::move(model)),
      geometry_(geometry),
      update_every_(std::max(1, static_cast<int>(std::lround(spec.update_period / period)))),
      pressure_(spec.moving_average, spec.symmetrical_derivative, period),
      position_(spec.moving_average, spec.symmetrical_derivative, period),
      spool_(spec.moving_average, spec.symmetrical_derivative, period),
      rls_(MakeRls(spec)) {}

void PublishedEstimator::AddStretch(const Stretch& stretch, const SpanEquations&) {
  if (!stretch.continues) {
    pressure_.Reset();
    position_.Reset();
    spool_.Reset();
  }
  for (int k = stretch.continues ? 1 : 0; k < stretch.samples; ++k) {
    pressure_.Push(stretch[kPressureA][k]);
    position_.Push(stretch[kPosition][k]);
    const bool ready = spool_.Push(stretch[kSpool][k]);
    if (!ready || ++since_update_ < update_every_) continue;
    since_update_ = 0;
    Learn(pressure_.value(), pressure_.derivative(), position_.value(), position_.derivative(),
          spool_.value());
  }
}

void PublishedEstimator::Learn(double p, double p_rate, double z, double speed, double y) {
  const double drop = p - geometry_.tank_pressure;
  const double root = std::copysign(std::sqrt(std::abs(drop)), drop);
  const std::array<double, 4> u = {root * y / kRegressorScale[0], p_rate / kRegressorScale[1],
                                   z * p_rate / kRegressorScale[2], root / kRegressorScale[3]};
  rls_.Update(u, geometry_.piston_area * speed / kOutputScale);
  squared_error_ += rls_.innovation() * rls_.innovation();
  errors_ += 1;
}

Eigen::VectorXd PublishedEstimator::theta() const {
  Eigen::VectorXd theta = rls_.theta();
  for (int i = 0; i < 4; ++i) theta[i] *= kOutputScale / kRegressorScale[i];
  return theta;
}

std::vector<Estimate> PublishedEstimator::EndStroke(const StrokeSummary& stroke, const StrokeGram&) {
  Eigen::VectorXd unit(4);
  for (int i = 0; i < 4; ++i) unit[i] = kOutputScale / kRegressorScale[i];
  const double variance = errors_ > 0 ? squared_error_ / errors_ : 1.0;
  squared_error_ = errors_ = 0;
  const Eigen::MatrixXd covariance = variance * (unit.asDiagonal() * rls_.Covariance() * unit.asDiagonal());
  std::vector<Estimate> estimates;
  for (const DerivedParameter& parameter : model_->derive(theta())) {
    Estimate e;
    e.parameter = parameter.name;
    e.value = parameter.value;
    e.unit = parameter.unit;
    e.std = std::hypot(std::sqrt(NonNegative(parameter.gradient.dot(covariance * parameter.gradient))),
                       parameter.geometry_std);
    e.excitation = 1.0;
    e.last_excited = stroke.end;
    e.reason = parameter.admissible ? EstimateReason::kUpdated : EstimateReason::kOutsidePhysics;
    estimates.push_back(e);
  }
  return estimates;
}

void PublishedEstimator::Save(ByteWriter& out) const {
  out.Put(rls_.Save());
  out.Put(since_update_);
}

bool PublishedEstimator::Restore(ByteReader& in) {
  rls_.Restore(in.Get<RecursiveLeastSquares::State>());
  since_update_ = in.Get<int>();
  return in.ok();
}

}  // namespace hydroscope
