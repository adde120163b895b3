#include "estimation/integral_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hydroscope {
namespace {

constexpr std::size_t kRecentStrokes = 64;
constexpr std::size_t kMaxWaiting = 20000;  ///< equations kept while the first strokes excite too little to start
constexpr double kVarianceMemory = 20.0;    ///< strokes over which the noise level is averaged

std::vector<int> FirstColumns(int count) {
  std::vector<int> columns(count);
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
}

/// A std beyond which the value says nothing useful about the parameter.
double UsefulStd(const DerivedParameter& parameter) {
  return parameter.unit == "1" ? 0.05 : 0.3 * std::abs(parameter.value);
}

void PutVector(ByteWriter& out, const Eigen::VectorXd& v) {
  for (double x : v) out.Put(x);
}

void PutEquations(ByteWriter& out, const NormalEquations& e) {
  for (double x : e.h.reshaped()) out.Put(x);
  PutVector(out, e.g);
  out.Put(e.yy);
  out.Put(e.equations);
}

NormalEquations GetEquations(ByteReader& in, int n) {
  NormalEquations e{Eigen::MatrixXd(n, n), Eigen::VectorXd(n), 0, 0};
  for (double& x : e.h.reshaped()) x = in.Get<double>();
  for (double& x : e.g) x = in.Get<double>();
  e.yy = in.Get<double>();
  e.equations = in.Get<double>();
  return e;
}

}  // namespace

IntegralEstimator::IntegralEstimator(const EstimatorSpec& spec, std::shared_ptr<const ModelStructure> model,
                                     const WindowSamples& window)
    : spec_(spec),
      model_(std::move(model)),
      block_time_(window.block * window.period),
      equation_(model_->base_count + 1),
      last_excited_(16, std::numeric_limits<double>::quiet_NaN()) {}

void IntegralEstimator::AddStretch(const Stretch&, const SpanEquations& equations) {
  const int size = model_->base_count + 1;
  for (int j = 0; j + 1 < equations.blocks; ++j) {
    const double* equation = equations.integral.col(j).data();
    if (rls_)
      Learn(equation);
    else if (waiting_.size() < kMaxWaiting * size)
      waiting_.insert(waiting_.end(), equation, equation + size);
  }
}

void IntegralEstimator::Start(const NormalEquations& first) {
  const Eigen::VectorXd theta = SolveNormalEquations(first);
  if (theta.size() == 0 || first.equations < 3 * model_->base_count) return;
  noise_ = std::sqrt(std::max(MeanSquaredError(first, theta), 1e-300));
  scale_ = (first.h.diagonal() / first.equations).cwiseSqrt().cwiseInverse();
  signal_variance_ = std::max(first.yy / first.equations / (noise_ * noise_), 1.0);
  Eigen::VectorXd initial = Eigen::VectorXd::Constant(model_->base_count, spec_.initial_parameter);
  if (spec_.initial_from_first_stroke) initial = theta.cwiseQuotient(scale_) / noise_;
  CreateRecursion(initial);
  for (std::size_t k = 0; k < waiting_.size(); k += equation_.size()) Learn(&waiting_[k]);
  waiting_.clear();
  waiting_.shrink_to_fit();
}

void IntegralEstimator::CreateRecursion(const Eigen::VectorXd& initial) {
  RecursiveLeastSquares::Options options;
  options.forgetting = spec_.form == EstimatorForm::kDirectional ? Forgetting::kDirectional : Forgetting::kExponential;
  options.forgetting_factor =
      spec_.form == EstimatorForm::kDirectional ? std::exp(-block_time_ / spec_.time_constant) : spec_.forgetting_factor;
  for (int i = 0; i < model_->base_count; ++i) {
    const auto own = spec_.time_constants.find(model_->parameters[i]);
    if (own != spec_.time_constants.end()) options.factors[i] = std::exp(-block_time_ / own->second);
  }
  options.initial_covariance = spec_.initial_covariance * signal_variance_;
  options.max_covariance = std::max(spec_.max_covariance * signal_variance_, options.initial_covariance);
  options.dead_zone = spec_.dead_zone;
  options.clip = spec_.clip;
  rls_.emplace(std::span<const double>(initial.data(), initial.size()), options);
}

void IntegralEstimator::Learn(const double* equation) {
  const int n = model_->base_count;
  for (int i = 0; i < n; ++i) equation_[i] = equation[i] * scale_[i];
  rls_->Update(std::span<const double>(equation_.data(), n), equation[n] / noise_);
}

Eigen::VectorXd IntegralEstimator::theta() const {
  if (!rls_) return {};
  return rls_->theta().cwiseProduct(scale_) * noise_;
}

IntegralEstimator::Weighted IntegralEstimator::Weigh(const Eigen::VectorXd& theta) const {
  const int n = model_->base_count;
  Weighted sum{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0};
  double age = 0, weights = 0, squares = 0;
  for (const Recent& stroke : recent_) {  // newest first
    const double weight = std::exp(-age * block_time_ / spec_.time_constant);
    age += stroke.raw.equations;
    sum.h += weight * stroke.raw.h;
    sum.noise_h += weight * stroke.noise.h;
    sum.bias += weight * (stroke.noise.h * theta - stroke.noise.g);
    weights += weight;
    squares += weight * weight;
  }
  const Eigen::VectorXd corrected = theta + sum.h.ldlt().solve(sum.bias);
  age = 0;
  for (const Recent& stroke : recent_) {
    const double weight = std::exp(-age * block_time_ / spec_.time_constant);
    age += stroke.raw.equations;
    const Eigen::VectorXd score =
        weight * (stroke.raw.g - stroke.noise.g - (stroke.raw.h - stroke.noise.h) * corrected);
    sum.meat += score * score.transpose();
  }
  sum.strokes = squares > 0 ? weights * weights / squares : 0.0;
  return sum;
}

std::vector<Estimate> IntegralEstimator::EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) {
  const std::vector<int> columns = FirstColumns(model_->base_count);
  NormalEquations raw = IntegralEquations(gram, columns, model_->output_column(), NoiseCorrection::kKeep);
  NormalEquations clean = IntegralEquations(gram, columns, model_->output_column());
  NormalEquations noise = raw;
  noise -= clean;
  recent_.push_front({raw, noise});
  if (recent_.size() > kRecentStrokes) recent_.pop_back();
  if (!rls_) {
    NormalEquations all;
    for (const Recent& r : recent_) all += r.raw;
    Start(all);
    if (!rls_) return {};
  }
  const Eigen::VectorXd present = theta();
  const double mean_square = MeanSquaredError(raw, present) / (noise_ * noise_);
  const double memory = std::min<double>(kVarianceMemory, static_cast<double>(recent_.size()));
  variance_ += (mean_square - variance_) / memory;
  rls_->set_noise_scale(std::sqrt(variance_));

  const Weighted recent = Weigh(present);
  const Eigen::VectorXd corrected = present + recent.h.ldlt().solve(recent.bias);
  const Eigen::VectorXd unit = scale_ * noise_;
  const Eigen::MatrixXd covariance = variance_ * (unit.asDiagonal() * rls_->Covariance() * unit.asDiagonal());
  std::vector<Estimate> estimates;
  for (const DerivedParameter& parameter : model_->derive(corrected)) {
    const std::size_t index = estimates.size();
    Estimate estimate = Describe(parameter, recent, covariance, OwnStd(parameter, recent_.front(), corrected));
    if (estimate.reason == EstimateReason::kUpdated || estimate.reason == EstimateReason::kOutsidePhysics)
      last_excited_[index] = stroke.end;
    estimate.last_excited = last_excited_[index];
    estimates.push_back(estimate);
  }
  return estimates;
}

double IntegralEstimator::OwnStd(const DerivedParameter& parameter, const Recent& stroke,
                                 const Eigen::VectorXd& theta) const {
  const double equations = std::max(stroke.raw.equations, 1.0);
  int dominant = 0;
  parameter.gradient.cwiseProduct(theta).cwiseAbs().maxCoeff(&dominant);
  // Share of the regressor's energy that is signal; the noise share itself is only known to sqrt(2 / equations).
  const double noise_share = stroke.noise.h(dominant, dominant) / std::max(stroke.raw.h(dominant, dominant), 1e-300);
  const double signal_share = 1.0 - noise_share - 3.0 * std::sqrt(2.0 / equations);
  if (!(signal_share > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd ridge = stroke.raw.h.diagonal().cwiseMax(1e-300) * (1e-9 / equations);
  const Eigen::MatrixXd own = stroke.raw.h + Eigen::MatrixXd(ridge.asDiagonal());
  const double promised = parameter.gradient.dot(own.ldlt().solve(parameter.gradient)) * variance_;
  return std::sqrt(std::max(0.0, promised)) * noise_ / signal_share;
}

Estimate IntegralEstimator::Describe(const DerivedParameter& parameter, const Weighted& recent,
                                     const Eigen::MatrixXd& covariance, double own_std) const {
  const Eigen::VectorXd& gradient = parameter.gradient;
  const double promised = std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
  double scattered = 0;
  if (recent.strokes > 2) {
    const Eigen::VectorXd bread = recent.h.ldlt().solve(gradient);
    const double small_sample = recent.strokes / (recent.strokes - 1);
    scattered = std::sqrt(std::max(0.0, bread.dot(recent.meat * bread)) * small_sample) * StudentFactor(recent.strokes - 1);
  } else {
    scattered = 2.0 * promised;  // one or two strokes do not show how strokes scatter
  }
  Estimate estimate;
  estimate.parameter = parameter.name;
  estimate.value = parameter.value;
  estimate.unit = parameter.unit;
  estimate.std = std::hypot(std::max(promised, scattered), parameter.geometry_std);
  const double useful = UsefulStd(parameter);
  estimate.excitation = useful / std::hypot(useful, own_std);
  if (!parameter.admissible)
    estimate.reason = EstimateReason::kOutsidePhysics;
  else if (own_std > useful)
    estimate.reason = EstimateReason::kNotExcited;
  else if (estimate.std > useful)
    estimate.reason = EstimateReason::kConfounded;
  else
    estimate.reason = EstimateReason::kUpdated;
  return estimate;
}

void IntegralEstimator::Save(ByteWriter& out) const {
  out.Put<std::uint8_t>(rls_.has_value());
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(recent_.size()));
  for (const Recent& r : recent_) {
    PutEquations(out, r.raw);
    PutEquations(out, r.noise);
  }
  for (double t : last_excited_) out.Put(t);
  if (!rls_) {
    out.Put<std::uint32_t>(static_cast<std::uint32_t>(waiting_.size()));
    for (double x : waiting_) out.Put(x);
    return;
  }
  PutVector(out, scale_);
  out.Put(noise_);
  out.Put(variance_);
  out.Put(signal_variance_);
  out.Put(rls_->Save());
}

bool IntegralEstimator::Restore(ByteReader& in) {
  const int n = model_->base_count;
  const bool running = in.Get<std::uint8_t>() != 0;
  const auto strokes = in.Get<std::uint32_t>();
  if (strokes > kRecentStrokes) return false;
  recent_.clear();
  for (std::uint32_t s = 0; s < strokes; ++s) recent_.push_back({GetEquations(in, n), GetEquations(in, n)});
  for (double& t : last_excited_) t = in.Get<double>();
  rls_.reset();
  waiting_.clear();
  if (!running) {
    const auto size = in.Get<std::uint32_t>();
    if (size > kMaxWaiting * equation_.size()) return false;
    waiting_.resize(size);
    for (double& x : waiting_) x = in.Get<double>();
    return in.ok();
  }
  scale_.resize(n);
  for (double& x : scale_) x = in.Get<double>();
  noise_ = in.Get<double>();
  variance_ = in.Get<double>();
  signal_variance_ = in.Get<double>();
  if (!in.ok()) return false;
  CreateRecursion(Eigen::VectorXd::Zero(n));
  rls_->Restore(in.Get<RecursiveLeastSquares::State>());
  return in.ok();
}

}  // namespace hydroscope
