#include "pipeline/added_effects_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/told_error.h"
#include "estimation/gram_fit.h"
#include "models/find_effect.h"

namespace hydroscope {
namespace {

/// Strokes kept while they do not yet tell the effects apart.
constexpr std::size_t kMostWaiting = 64;
constexpr std::size_t kLeastStored = 16;  ///< "last excited at" of a stored state, whatever the parameters
/// Share of a regressor's energy that must be more than sensor noise for a stroke to count as moving it.
constexpr double kSignalShare = 0.5;

SymmetricMatrix Congruence(const SymmetricMatrix& gram, const Eigen::MatrixXd& weights) {
  const auto columns = weights.rows();
  Eigen::MatrixXd full(columns, columns);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i <= j; ++i) full(i, j) = full(j, i) = gram(i, j);
  const Eigen::MatrixXd reduced = weights.transpose() * full * weights;
  SymmetricMatrix out(static_cast<int>(reduced.rows()));
  for (int j = 0; j < reduced.rows(); ++j)
    for (int i = 0; i <= j; ++i) out(i, j) = reduced(i, j);
  return out;
}

/// Values of the effect's nonlinear parameters in their order; empty if the machine file does not give all.
Result<std::vector<double>> GivenValues(const Machine& machine, const Effect& effect) {
  const auto given = machine.effect_values.find(effect.id);
  std::vector<double> values;
  if (given == machine.effect_values.end()) return values;
  for (const auto& [name, value] : given->second)
    if (std::ranges::none_of(effect.nonlinear, [&name = name](const auto& n) { return n.name == name; }))
      return BadInput(Tell("machine {}: effect_values of {}: it has no parameter {}",
                           "Maschine {}: effect_values von {}: es hat keinen Parameter {}", machine.name,
                           effect.id, name));
  for (const NonlinearParameter& n : effect.nonlinear)
    if (const auto value = given->second.find(n.name); value != given->second.end())
      values.push_back(value->second);
  if (values.size() != effect.nonlinear.size()) values.clear();
  return values;
}

}  // namespace

Result<std::shared_ptr<const ModelStructure>> AddedEffectsEstimator::ModelWithValues(
    const Machine& machine, const ModelStructure& model) {
  if (machine.added_effects.size() > kMostEffects)
    return BadInput(
        Tell("machine {}: {} effects are part of the model, at most {} can be identified with it",
             "Maschine {}: {} Effekte gehören zum Modell, höchstens {} lassen sich mit ihm identifizieren",
             machine.name, machine.added_effects.size(), kMostEffects));
  auto wide = std::make_shared<ModelStructure>(model);
  std::vector<EffectChoice> added;
  std::vector<std::vector<double>> given;
  for (const std::string& id : machine.added_effects) {
    const auto effect = TRY(FindEffect(model, id));
    auto values = TRY(GivenValues(machine, *model.effects[effect]));
    added.push_back({effect, 0});
    given.push_back(std::move(values));
  }
  for (std::size_t k = 0; k < added.size(); ++k) {
    const auto on = CorrectionOf(model, added, given, k);
    if (given[k].size() != model.effects[added[k].effect]->nonlinear.size() || (given[k].empty() && !on))
      continue;
    wide->effect_shapes[added[k].effect].clear();
    AddShape(*wide, added[k].effect, given[k], on);
  }
  return std::shared_ptr<const ModelStructure>(std::move(wide));
}

AddedEffectsEstimator::AddedEffectsEstimator(const Machine& machine,
                                             std::shared_ptr<const ModelStructure> model,
                                             const WindowSamples& window)
    : machine_(machine), model_(std::move(model)), window_(window) {
  for (const std::string& id : machine_.added_effects) effects_.push_back(*FindEffect(*model_, id));
}

void AddedEffectsEstimator::AddStretch(const Stretch& stretch, const SpanEquations& equations) {
  if (inner_)
    inner_->AddStretch(stretch, Reduced(equations));
  else
    present_.push_back(equations);
}

void AddedEffectsEstimator::DiscardStroke() {
  present_.clear();
  if (inner_) inner_->DiscardStroke();
}

std::vector<Estimate> AddedEffectsEstimator::EndStroke(const StrokeSummary& stroke, const StrokeGram& gram) {
  if (!inner_) {
    waiting_.push_back({std::move(present_), stroke, gram});
    present_.clear();
    if (waiting_.size() > kMostWaiting) waiting_.pop_front();
    if (waiting_.size() >= kFirstStrokes) Start();
    if (!inner_) return {};
    std::vector<Estimate> estimates;
    for (const Waiting& earlier : waiting_) {
      for (const SpanEquations& span : earlier.spans) inner_->AddStretch({}, Reduced(span));
      const StrokeGram reduced = Reduced(earlier.gram);
      estimates = inner_->EndStroke(earlier.summary, reduced);
      JudgeGivenOthers(earlier.summary, reduced, estimates);
    }
    waiting_.clear();
    return estimates;
  }
  const StrokeGram reduced = Reduced(gram);
  std::vector<Estimate> estimates = inner_->EndStroke(stroke, reduced);
  JudgeGivenOthers(stroke, reduced, estimates);
  if (const Eigen::VectorXd present = inner_->theta(); present.size() > 0 && present.allFinite())
    Linearise(present);
  return estimates;
}

void AddedEffectsEstimator::Start() {
  std::vector<StrokeGram> grams;
  for (const Waiting& stroke : waiting_) grams.push_back(stroke.gram);
  const StrokeSet strokes(model_, grams, window_);
  std::vector<EffectChoice> choices;
  for (const int effect : effects_) {
    choices.push_back(strokes.BestShape(effect, choices));
    if (choices.back().shape < 0) return;
  }
  const ExtendedFit fit = strokes.Fit(choices);
  if (!fit.solved) return;
  choices_ = choices;
  Linearise(fit.theta);
  Begin();
}

void AddedEffectsEstimator::Begin() {
  reduced_ = ReducedModel();
  inner_ = MakeEstimator(machine_, reduced_, window_);
}

void AddedEffectsEstimator::JudgeGivenOthers(const StrokeSummary& stroke, const StrokeGram& reduced,
                                             std::vector<Estimate>& estimates) {
  const Eigen::VectorXd present = inner_->theta();
  last_excited_.resize(StoredTimes(), std::numeric_limits<double>::quiet_NaN());
  if (present.size() == 0 || reduced.integral.dimension() == 0) return;
  std::vector<int> columns(static_cast<std::size_t>(regressors()));
  std::iota(columns.begin(), columns.end(), 0);
  const NormalEquations raw = IntegralEquations(reduced, columns, regressors(), NoiseCorrection::kKeep);
  const NormalEquations clean = IntegralEquations(reduced, columns, regressors());
  const double variance = MeanSquaredError(raw, present);
  const std::vector<DerivedParameter> derived = reduced_->derive(present);
  for (std::size_t k = 0; k < std::min({estimates.size(), derived.size(), last_excited_.size()}); ++k) {
    Estimate& estimate = estimates[k];
    int own = 0;
    derived[k].gradient.cwiseProduct(present).cwiseAbs().maxCoeff(&own);
    const double useful = derived[k].useful_std();
    const double given =
        std::abs(derived[k].gradient[own]) * std::sqrt(variance / std::max(clean.h(own, own), 1e-300));
    const bool moved = clean.h(own, own) > kSignalShare * raw.h(own, own);
    if (estimate.reason == EstimateReason::kNotExcited && moved && given < useful && estimate.std < useful) {
      estimate.reason = EstimateReason::kUpdated;
      estimate.excitation = useful / std::hypot(useful, given);
    }
    if (estimate.reason == EstimateReason::kUpdated) last_excited_[k] = stroke.end;
    estimate.last_excited = last_excited_[k];
  }
}

void AddedEffectsEstimator::Linearise(const Eigen::VectorXd& theta) {
  const int base = model_->base_count, n = regressors();
  weights_ = Eigen::MatrixXd::Zero(model_->column_count(), n + 1);
  for (int c = 0; c < base; ++c) weights_(c, c) = 1;
  for (std::size_t k = 0; k < choices_.size(); ++k) {
    const EffectShape& shape = model_->effect_shapes[choices_[k].effect][choices_[k].shape];
    const int column = base + static_cast<int>(k);
    const std::vector<double> weights = shape.weights({theta.head(base), theta[column]});
    for (std::size_t j = 0; j < weights.size(); ++j) weights_(shape.columns[j], column) += weights[j];
  }
  weights_(model_->output_column(), n) = 1;
}

SpanEquations AddedEffectsEstimator::Reduced(const SpanEquations& equations) const {
  SpanEquations out;
  out.integral = weights_.transpose() * equations.integral.leftCols(equations.equations);
  out.noise = weights_.transpose() * equations.noise.leftCols(equations.blocks);
  out.walk = weights_.transpose() * equations.walk;
  out.blocks = equations.blocks;
  out.equations = equations.equations;
  out.begin = equations.begin;
  return out;
}

StrokeGram AddedEffectsEstimator::Reduced(const StrokeGram& gram) const {
  if (gram.integral.dimension() == 0) return gram;
  StrokeGram out = gram;
  out.integral = Congruence(gram.integral, weights_);
  out.noise = Congruence(gram.noise, weights_);
  out.flow = Congruence(gram.flow, weights_);
  return out;
}

std::shared_ptr<const ModelStructure> AddedEffectsEstimator::ReducedModel() const {
  auto reduced = std::make_shared<ModelStructure>();
  reduced->name = model_->name;
  reduced->base_count = regressors();
  reduced->columns.resize(static_cast<std::size_t>(regressors()) + 1);
  reduced->parameters = model_->parameters;
  for (const int effect : effects_)
    reduced->parameters.push_back(model_->effects[effect]->id + "." + model_->effects[effect]->parameter);
  reduced->output_unit = model_->output_unit;
  reduced->level_form = model_->level_form;
  reduced->derive = [model = model_, effects = effects_](const Eigen::VectorXd& theta) {
    std::vector<DerivedParameter> derived = model->derive(theta.head(model->base_count));
    for (DerivedParameter& parameter : derived) {
      const Eigen::VectorXd own = parameter.gradient;
      parameter.gradient = Eigen::VectorXd::Zero(theta.size());
      parameter.gradient.head(own.size()) = own;
    }
    for (std::size_t k = 0; k < effects.size(); ++k) {
      const Effect& effect = *model->effects[effects[k]];
      const int at = model->base_count + static_cast<int>(k);
      derived.push_back({effect.id + "." + effect.parameter, effect.unit, theta[at],
                         Eigen::VectorXd::Unit(theta.size(), at),
                         theta[at] >= effect.min && theta[at] <= effect.max, 0.0});
    }
    return derived;
  };
  return reduced;
}

Eigen::VectorXd AddedEffectsEstimator::theta() const { return inner_ ? inner_->theta() : Eigen::VectorXd(); }

Eigen::VectorXd AddedEffectsEstimator::ColumnWeights(const Eigen::VectorXd& theta) const {
  if (theta.size() != regressors() || weights_.size() == 0) return {};
  return weights_.leftCols(regressors()) * theta;
}

std::size_t AddedEffectsEstimator::StoredTimes() const {
  return std::max(kLeastStored,
                  model_->derive(Eigen::VectorXd::Ones(model_->base_count)).size() + effects_.size());
}

void AddedEffectsEstimator::Save(ByteWriter& out) const {
  out.Put<std::uint8_t>(inner_ != nullptr);
  out.Put<std::uint32_t>(static_cast<std::uint32_t>(effects_.size()));
  for (const int effect : effects_) out.Put<std::int32_t>(effect);
  if (!inner_) return;
  for (const EffectChoice& choice : choices_) out.Put<std::int32_t>(choice.shape);
  for (const double w : weights_.reshaped()) out.Put(w);
  for (std::size_t k = 0; k < StoredTimes(); ++k)
    out.Put(k < last_excited_.size() ? last_excited_[k] : std::numeric_limits<double>::quiet_NaN());
  inner_->Save(out);
}

bool AddedEffectsEstimator::Restore(ByteReader& in) {
  const bool started = in.Get<std::uint8_t>() != 0;
  if (in.Get<std::uint32_t>() != effects_.size()) return false;
  for (const int effect : effects_)
    if (in.Get<std::int32_t>() != effect) return false;
  waiting_.clear();
  present_.clear();
  inner_.reset();
  choices_.clear();
  if (!started) return true;
  for (const int effect : effects_) {
    const int shape = in.Get<std::int32_t>();
    if (shape < 0 || shape >= static_cast<int>(model_->effect_shapes[effect].size())) return false;
    choices_.push_back({effect, shape});
  }
  weights_.resize(model_->column_count(), regressors() + 1);
  for (double& w : weights_.reshaped()) w = in.Get<double>();
  last_excited_.resize(StoredTimes());
  for (double& t : last_excited_) t = in.Get<double>();
  Begin();
  return inner_->Restore(in);
}

}  // namespace hydroscope
