#include "estimation/recursive/published_estimator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/non_negative.h"

namespace hydroscope {
namespace {

RecursiveLeastSquares MakeRls(const EstimatorSpec& spec, std::size_t parameters) {
  RecursiveLeastSquares::Options options;
  options.forgetting =
      spec.form == EstimatorForm::kDirectional ? Forgetting::kDirectional : Forgetting::kExponential;
  options.forgetting_factor = spec.form == EstimatorForm::kDirectional
                                  ? std::exp(-spec.update_period / spec.time_constant)
                                  : spec.forgetting_factor;
  options.initial_covariance = spec.initial_covariance;
  options.max_covariance = std::max(spec.max_covariance, spec.initial_covariance);
  options.dead_zone = spec.dead_zone;
  const std::vector<double> initial(parameters, spec.initial_parameter);
  return RecursiveLeastSquares(initial, options);
}

}  // namespace

PublishedEstimator::PublishedEstimator(const EstimatorSpec& spec, std::shared_ptr<const ModelStructure> model,
                                       double period)
    : spec_(spec),
      model_(std::move(model)),
      update_every_(std::max(1, static_cast<int>(std::lround(spec.update_period / period)))),
      filters_(model_->published->channels.size(),
               PublishedFilter(spec.moving_average, spec.symmetrical_derivative, period)),
      value_(filters_.size()),
      rate_(filters_.size()),
      balance_(model_->published->regressor_scale.size() + 1),
      rls_(MakeRls(spec, model_->published->regressor_scale.size())) {}

void PublishedEstimator::AddStretch(const Stretch& stretch, const SpanEquations&) {
  if (!stretch.continues)
    for (PublishedFilter& filter : filters_) filter.Reset();
  for (int k = stretch.continues ? 1 : 0; k < stretch.samples; ++k) {
    if (!Push(stretch, k) || ++since_update_ < update_every_) continue;
    since_update_ = 0;
    Learn();
  }
}

/// True once the filters have values; all of them have the same delay.
bool PublishedEstimator::Push(const Stretch& stretch, int sample) {
  bool ready = true;
  for (std::size_t f = 0; f < filters_.size(); ++f)
    ready = filters_[f].Push(stretch[model_->published->channels[f]][sample]) && ready;
  return ready;
}

void PublishedEstimator::Learn() {
  for (std::size_t f = 0; f < filters_.size(); ++f) {
    value_[f] = filters_[f].value();
    rate_[f] = filters_[f].derivative();
  }
  const PublishedForm& form = *model_->published;
  form.at(value_, rate_, balance_);
  for (std::size_t i = 0; i < form.regressor_scale.size(); ++i) balance_[i] /= form.regressor_scale[i];
  rls_.Update(std::span(balance_).first(form.regressor_scale.size()), balance_.back() / form.output_scale);
  squared_error_ += rls_.innovation() * rls_.innovation();
  errors_ += 1;
}

/// SI per scaled parameter.
Eigen::VectorXd PublishedEstimator::Units() const {
  const PublishedForm& form = *model_->published;
  Eigen::VectorXd unit(static_cast<Eigen::Index>(form.regressor_scale.size()));
  for (Eigen::Index i = 0; i < unit.size(); ++i) unit[i] = form.output_scale / form.regressor_scale[i];
  return unit;
}

Eigen::VectorXd PublishedEstimator::theta() const { return rls_.theta().cwiseProduct(Units()); }

std::vector<Estimate> PublishedEstimator::EndStroke(const StrokeSummary& stroke, const StrokeGram&) {
  const Eigen::VectorXd unit = Units();
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
