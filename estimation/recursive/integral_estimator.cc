#include "estimation/recursive/integral_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/non_negative.h"
#include "estimation/decompositions.h"
#include "estimation/stroke_clusters.h"

namespace hydroscope {
namespace {

constexpr std::size_t kRecentStrokes = 64;
constexpr std::size_t kLeastStored = 16;   ///< "last excited at" of a stored state, whatever the parameters
constexpr std::size_t kMaxWaiting = 1000;  ///< spans kept while the first strokes excite too little to start
constexpr std::size_t kSettled = 3;  ///< strokes before errors of a span are judged against the noise level
/// Energy over the noise's share from which a direction counts as excited.
constexpr double kSignalToNoise = 10.0;
/// Of scaled regressors, per equation: below it a direction is rounding.
constexpr double kLeastEnergy = 1e-9;
constexpr double kVarianceMemory = 20.0;  ///< strokes over which the noise level is averaged

std::vector<int> FirstColumns(int count) {
  std::vector<int> columns(count);
  std::iota(columns.begin(), columns.end(), 0);
  return columns;
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
      memory_(spec.form == EstimatorForm::kDirectional ? std::exp(-block_time_ / spec.time_constant)
                                                       : spec.forgetting_factor),
      last_excited_(std::max(kLeastStored, model_->derive(Eigen::VectorXd::Ones(model_->base_count)).size()),
                    std::numeric_limits<double>::quiet_NaN()) {}

void IntegralEstimator::Share::Add(const Share& other, double weight) {
  if (gram.size() == 0) gram = noise = Small::Zero(other.gram.rows(), other.gram.cols());
  gram += weight * other.gram;
  noise += weight * other.noise;
  count += other.count;
}

void IntegralEstimator::AddStretch(const Stretch&, const SpanEquations& equations) {
  const int size = model_->base_count + 1;
  Share span{Small::Zero(size, size), Small::Zero(size, size), static_cast<double>(equations.equations)};
  for (int i = 0; i < size; ++i)
    for (int j = 0; j <= i; ++j) {
      for (int k = 0; k < equations.equations; ++k)
        span.gram(i, j) += equations.integral(i, k) * equations.integral(j, k);
      for (int k = 0; k < equations.blocks; ++k)
        span.noise(i, j) += equations.noise(i, k) * equations.noise(j, k);
      for (Eigen::Index k = 0; k < equations.walk.cols(); ++k)
        span.noise(i, j) += equations.walk(i, k) * equations.walk(j, k);
      span.gram(j, i) = span.gram(i, j);
      span.noise(j, i) = span.noise(i, j);
    }
  if (filter_)
    LearnSpan(span);
  else if (waiting_.size() < kMaxWaiting)
    waiting_.push_back({span.gram, span.noise, span.count});
}

void IntegralEstimator::Start(const NormalEquations& first, double oil_temperature) {
  const int n = model_->base_count;
  const Eigen::VectorXd theta = SolveNormalEquations(first);
  if (theta.size() == 0 || first.equations < 3 * n) return;
  noise_ = std::sqrt(std::max(MeanSquaredError(first, theta), 1e-300));
  scale_.resize(n + 1);
  scale_.head(n) = (first.h.diagonal() / first.equations).cwiseSqrt().cwiseInverse();
  scale_[n] = 1.0 / noise_;
  noise_ = 1.0 / scale_[n];  // exactly what a restored state has
  const double signal_variance = std::max(first.yy / first.equations / (noise_ * noise_), 1.0);
  Eigen::VectorXd initial = Eigen::VectorXd::Constant(n, spec_.initial_parameter);
  if (spec_.initial_from_first_stroke) initial = theta.cwiseQuotient(scale_.head(n)) / noise_;
  filter_.emplace(initial, spec_.initial_covariance * signal_variance,
                  std::max(spec_.max_covariance, spec_.initial_covariance) * signal_variance);
  RelateParameters(theta);
  for (const Waiting& span : waiting_) LearnSpan({span.gram, span.noise, span.count});
  waiting_.clear();
  waiting_.shrink_to_fit();
  LearnStroke(oil_temperature);
}

IntegralEstimator::Small IntegralEstimator::ExcitedDirections(const Share& stroke) {
  const auto n = stroke.gram.rows() - 1;
  const SymmetricEigen eigen = EigenOf(stroke.gram.topLeftCorner(n, n));
  Small basis = Small::Zero(n, n);
  int excited = 0;
  for (Eigen::Index d = 0; d < n; ++d) {
    const InformationFilter::Vector direction = eigen.vectors.col(d);
    const double noise_energy = direction.dot(stroke.noise.topLeftCorner(n, n) * direction);
    const double energy = eigen.values[d];
    if (energy > kSignalToNoise * noise_energy && energy > kLeastEnergy * stroke.count)
      basis.col(excited++) = direction;
  }
  basis.conservativeResize(n, excited);
  return basis;
}

void IntegralEstimator::Forget(const Small& basis, double count) {
  if (spec_.time_constants.empty() || spec_.form == EstimatorForm::kExponential) {
    filter_->Forget(basis, std::pow(memory_, count));
    return;
  }
  // One time constant per parameter: a direction forgets at the mean of its parameters' rates, by their
  // shares in it.
  for (Eigen::Index d = 0; d < basis.cols(); ++d) {
    double rate = 0;
    for (int i = 0; i < model_->base_count; ++i) rate += basis(i, d) * basis(i, d) / time_constants_[i];
    filter_->Forget(basis.col(d), std::exp(-rate * block_time_ * count));
  }
}

void IntegralEstimator::RelateParameters(const Eigen::VectorXd& theta) {
  const std::vector<DerivedParameter> derived = model_->derive(theta);
  own_ = OwnParameters(derived, theta);
  time_constants_.assign(model_->base_count, spec_.time_constant);
  const auto set = [&](const std::string& name, int parameter) {
    if (const auto own = spec_.time_constants.find(name); own != spec_.time_constants.end())
      time_constants_[parameter] = own->second;
  };
  for (std::size_t i = 0; i < derived.size(); ++i) set(derived[i].name, own_[i]);
  for (int i = 0; i < model_->base_count; ++i) set(model_->parameters[i], i);
}

void IntegralEstimator::LearnSpan(const Share& span) {
  const int n = model_->base_count;
  const Share scaled{scale_.asDiagonal() * span.gram * scale_.asDiagonal(),
                     scale_.asDiagonal() * span.noise * scale_.asDiagonal(), span.count};
  InformationFilter::Vector coefficients(n + 1);
  coefficients << -filter_->Theta(), 1.0;
  // Mean square of the innovations in noise variances.
  const double innovation = coefficients.dot(scaled.gram * coefficients) / (variance_ * span.count);
  if (settled_ && innovation < spec_.dead_zone * spec_.dead_zone) {
    ++counts_.in_dead_zone;
    return;
  }
  const bool clip = settled_ && spec_.clip > 0 && innovation > spec_.clip * spec_.clip;
  ++(clip ? counts_.clipped : counts_.learned);
  stroke_.Add(scaled, clip ? spec_.clip * spec_.clip / innovation : 1.0);
}

void IntegralEstimator::LearnStroke(double oil_temperature) {
  if (stroke_.count == 0) return;
  const int n = model_->base_count;
  Forget(
      spec_.form == EstimatorForm::kDirectional ? ExcitedDirections(stroke_) : Small(Small::Identity(n, n)),
      stroke_.count);
  const Small signal = stroke_.gram - stroke_.noise;
  filter_->Add(signal.topLeftCorner(n, n), signal.col(n).head(n), oil_temperature);
  stroke_ = {};
}

Eigen::VectorXd IntegralEstimator::theta() const {
  if (!filter_) return {};
  return filter_->Theta().cwiseProduct(scale_.head(model_->base_count)) * noise_;
}

IntegralEstimator::Weighted IntegralEstimator::Weigh(const Eigen::VectorXd& theta) const {
  const int n = model_->base_count;
  Weighted sum{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), {}, 0};
  double age = 0, weights = 0, squares = 0;
  for (const Recent& stroke : recent_) {  // newest first
    const double weight = std::pow(memory_, age);
    age += stroke.raw.equations;
    const Eigen::VectorXd score =
        weight * (stroke.raw.g - stroke.noise.g - (stroke.raw.h - stroke.noise.h) * theta);
    sum.h += weight * stroke.raw.h;
    sum.meat += score * score.transpose();
    sum.weights.push_back(weight);
    weights += weight;
    squares += weight * weight;
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
  if (filter_) {
    LearnStroke(stroke.oil_temperature);
  } else {
    NormalEquations all;
    for (const Recent& r : recent_) all += r.raw;
    Start(all, stroke.oil_temperature);
    if (!filter_) return {};
  }
  const Eigen::VectorXd present = theta();
  const double mean_square = MeanSquaredError(raw, present) / (noise_ * noise_);
  const double memory = std::min<double>(kVarianceMemory, static_cast<double>(recent_.size()));
  variance_ += (mean_square - variance_) / memory;
  settled_ = recent_.size() >= kSettled;

  const Weighted recent = Weigh(present);
  const Eigen::VectorXd unit = scale_.head(model_->base_count) * noise_;
  const Eigen::MatrixXd covariance =
      variance_ * (unit.asDiagonal() * filter_->Covariance() * unit.asDiagonal());
  const InformationFilter::Vector condition = filter_->Condition();
  std::vector<Estimate> estimates;
  for (const DerivedParameter& parameter : model_->derive(present)) {
    const std::size_t index = estimates.size();
    Estimate estimate =
        Describe(parameter, recent, covariance, OwnStd(parameter, own_[index], recent_.front()));
    if (estimate.reason == EstimateReason::kUpdated || estimate.reason == EstimateReason::kOutsidePhysics)
      last_excited_[index] = stroke.end;
    estimate.last_excited = last_excited_[index];
    estimate.oil_temperature = condition[own_[index]];
    estimates.push_back(estimate);
  }
  return estimates;
}

double IntegralEstimator::OwnStd(const DerivedParameter& parameter, int own_regressor,
                                 const Recent& stroke) const {
  const double equations = std::max(stroke.raw.equations, 1.0);
  // Share of the regressor's energy that is signal; the noise share itself is only known to sqrt(2 / equations).
  const double noise_share = stroke.noise.h(own_regressor, own_regressor) /
                             std::max(stroke.raw.h(own_regressor, own_regressor), 1e-300);
  const double signal_share = 1.0 - noise_share - 3.0 * std::sqrt(2.0 / equations);
  if (!(signal_share > 0)) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd ridge = stroke.raw.h.diagonal().cwiseMax(1e-300) * (1e-9 / equations);
  const Eigen::MatrixXd own = stroke.raw.h + Eigen::MatrixXd(ridge.asDiagonal());
  const double promised = parameter.gradient.dot(SymmetricFactor(own).Solve(parameter.gradient)) * variance_;
  return std::sqrt(NonNegative(promised)) * noise_ / signal_share;
}

double IntegralEstimator::StrokesThatTellOf(const Eigen::VectorXd& bread, const Weighted& recent) const {
  double sum = 0, squares = 0;
  for (std::size_t s = 0; s < recent_.size(); ++s) {
    const double share =
        recent.weights[s] * recent.weights[s] * NonNegative(bread.dot(recent_[s].raw.h * bread));
    sum += share;
    squares += share * share;
  }
  return AlikeStrokes(sum, squares);
}

Estimate IntegralEstimator::Describe(const DerivedParameter& parameter, const Weighted& recent,
                                     const Eigen::MatrixXd& covariance, double own_std) const {
  const Eigen::VectorXd& gradient = parameter.gradient;
  const double promised = std::sqrt(NonNegative(gradient.dot(covariance * gradient)));
  double scattered = 0;
  if (recent.strokes > 2) {
    const Eigen::VectorXd bread = SymmetricFactor(recent.h).Solve(gradient);
    const double small_sample = recent.strokes / (recent.strokes - 1);
    scattered = std::sqrt(NonNegative(bread.dot(recent.meat * bread)) * small_sample) *
                StudentFactor(StrokesThatTellOf(bread, recent) - 1);
  } else {
    scattered = 2.0 * promised;  // one or two strokes do not show how strokes scatter
  }
  Estimate estimate;
  estimate.parameter = parameter.name;
  estimate.value = parameter.value;
  estimate.unit = parameter.unit;
  estimate.std = std::hypot(std::max(promised, scattered), parameter.geometry_std);
  const double useful = parameter.useful_std();
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
  out.Put<std::uint8_t>(filter_.has_value());
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(recent_.size()));
  for (const Recent& r : recent_) {
    PutEquations(out, r.raw);
    PutEquations(out, r.noise);
  }
  for (double t : last_excited_) out.Put(t);
  out.Put(counts_);
  if (!filter_) {
    out.Put<std::uint32_t>(static_cast<std::uint32_t>(waiting_.size()));
    for (const Waiting& span : waiting_) {
      for (double x : span.gram.reshaped()) out.Put(x);
      for (double x : span.noise.reshaped()) out.Put(x);
      out.Put(span.count);
    }
    return;
  }
  PutVector(out, scale_);
  out.Put(variance_);
  out.Put(filter_->least_information());
  for (double x : filter_->information().reshaped()) out.Put(x);
  PutVector(out, filter_->state());
  for (double x : filter_->moment().reshaped()) out.Put(x);
}

bool IntegralEstimator::Restore(ByteReader& in) {
  const int n = model_->base_count;
  const bool running = in.Get<std::uint8_t>() != 0;
  const auto strokes = in.Get<std::uint32_t>();
  if (strokes > kRecentStrokes) return false;
  recent_.clear();
  for (std::uint32_t s = 0; s < strokes; ++s) recent_.push_back({GetEquations(in, n), GetEquations(in, n)});
  for (double& t : last_excited_) t = in.Get<double>();
  counts_ = in.Get<SpanCounts>();
  filter_.reset();
  waiting_.clear();
  stroke_ = {};
  return running ? RestoreFilter(in) : RestoreWaiting(in);
}

bool IntegralEstimator::RestoreWaiting(ByteReader& in) {
  const int size = model_->base_count + 1;
  noise_ = variance_ = 1.0;
  settled_ = false;
  const auto spans = in.Get<std::uint32_t>();
  if (spans > kMaxWaiting) return false;
  for (std::uint32_t k = 0; k < spans && in.ok(); ++k) {
    Waiting span{Eigen::MatrixXd(size, size), Eigen::MatrixXd(size, size), 0};
    for (double& x : span.gram.reshaped()) x = in.Get<double>();
    for (double& x : span.noise.reshaped()) x = in.Get<double>();
    span.count = in.Get<double>();
    waiting_.push_back(std::move(span));
  }
  return in.ok();
}

bool IntegralEstimator::RestoreFilter(ByteReader& in) {
  const int n = model_->base_count;
  scale_.resize(n + 1);
  for (double& x : scale_) x = in.Get<double>();
  noise_ = 1.0 / scale_[n];
  variance_ = in.Get<double>();
  const auto least_information = in.Get<double>();
  Small information(n, n), moment(n, n);
  InformationFilter::Vector state(n);
  for (double& x : information.reshaped()) x = in.Get<double>();
  for (double& x : state) x = in.Get<double>();
  for (double& x : moment.reshaped()) x = in.Get<double>();
  if (!in.ok() || !(least_information > 0)) return false;
  filter_.emplace(information, state, moment, least_information);
  settled_ = recent_.size() >= kSettled;
  RelateParameters(theta());
  return true;
}

}  // namespace hydroscope
