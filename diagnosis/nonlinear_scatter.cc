#include "diagnosis/nonlinear_scatter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "diagnosis/sample_grams.h"

namespace hydroscope {
namespace {

constexpr double kShift = 0.02;  ///< of a nonlinear parameter, relative: far enough to be told from it

/// The effects of a fit, one of them at other values of its nonlinear parameters.
class Shifting {
 public:
  Shifting(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
           const WindowSamples& window, std::span<const EffectChoice> choices)
      : strokes_(strokes), window_(window) {
    auto used = std::make_shared<ModelStructure>(BaseOnly(*model));  // no columns but those that count
    for (const EffectChoice& choice : choices) {
      const EffectShape& shape = model->effect_shapes[choice.effect][choice.shape];
      choices_.push_back({choice.effect, AddShape(*used, choice.effect, shape.nonlinear, shape.on)});
    }
    model_ = std::move(used);
  }

  const Effect& EffectOf(std::size_t k) const { return *model_->effects[choices_[k].effect]; }
  const std::vector<double>& Values(std::size_t k) const {
    return model_->effect_shapes[choices_[k].effect][choices_[k].shape].nonlinear;
  }
  int size() const { return static_cast<int>(choices_.size()); }
  int base() const { return model_->base_count; }

  double Shift(std::size_t k, std::size_t i) const {
    const double step = kShift * Values(k)[i];
    return Values(k)[i] + step <= EffectOf(k).nonlinear[i].max ? step : -step;
  }

  using Shapes = std::vector<std::pair<std::size_t, std::vector<double>>>;

  /// Fit of base and effects with shapes of some at other values, `instead` of theirs and `beside` them (last).
  ExtendedFit Fit(const Shapes& instead, const Shapes& beside) const {
    auto model = std::make_shared<ModelStructure>(*model_);
    std::vector<EffectChoice> choices = choices_;
    const auto add = [&](std::size_t k, const std::vector<double>& values) {
      const int effect = choices_[k].effect;
      return EffectChoice{
          effect, AddShape(*model, effect, values, model->effect_shapes[effect][choices_[k].shape].on)};
    };
    for (const auto& [k, values] : instead) choices[k] = add(k, values);
    for (const auto& [k, values] : beside) choices.push_back(add(k, values));
    return StrokeSet(model, GramsOf(model, strokes_, window_), window_).Fit(choices);
  }

 private:
  std::shared_ptr<const ModelStructure> model_;
  std::span<const StrokeStretches> strokes_;
  WindowSamples window_;
  std::vector<EffectChoice> choices_;
};

std::vector<double> Shifted(const Shifting& model, std::size_t k, std::size_t i) {
  std::vector<double> values = model.Values(k);
  values[i] += model.Shift(k, i);
  return values;
}

/// Whether shifting its nonlinear parameters by kShift says how they scatter: not if the law ties them to its
/// size, nor if they were searched for to far better than that.
bool IsFree(const Effect& effect) { return !effect.implied && !effect.grid.empty(); }

/// Nonlinear parameter `index` of effect `effect` of a fit.
struct FreeParameter {
  std::size_t effect = 0, index = 0;
};

/// Free parameters of which something (or nothing) is known beforehand.
std::vector<FreeParameter> FreeParameters(const Shifting& model, bool known) {
  std::vector<FreeParameter> out;
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.size()); ++k) {
    const Effect& effect = model.EffectOf(k);
    for (std::size_t i = 0; IsFree(effect) && i < effect.nonlinear.size(); ++i)
      if ((effect.nonlinear[i].std > 0) == known) out.push_back({k, i});
  }
  return out;
}

/// A fit with the shifted shapes of `parameters` beside the others: of theta with these parameters left free.
struct LeftFree {
  Eigen::MatrixXd covariance;  ///< of theta
  std::vector<double> std;     ///< of each of `parameters`
};

std::optional<LeftFree> FitLeftFree(const Shifting& model, const std::vector<FreeParameter>& parameters,
                                    const Eigen::VectorXd& theta) {
  if (parameters.empty()) return std::nullopt;
  Shifting::Shapes shapes;
  for (const auto& [k, i] : parameters) shapes.push_back({k, Shifted(model, k, i)});
  const ExtendedFit wide = model.Fit({}, shapes);
  if (!wide.solved) return std::nullopt;
  const Eigen::Index kept = theta.size();
  Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(kept, wide.theta.size());
  LeftFree out;
  for (std::size_t j = 0; j < shapes.size(); ++j) {
    const Eigen::Index column = kept + static_cast<int>(j),
                       own = model.base() + static_cast<int>(shapes[j].first);
    sum(own, column) = 1;
    // s X(eta) + ds X(eta + shift) = (s + ds) X(eta + shift ds / s) to first order
    const auto& [k, i] = parameters[j];
    out.std.push_back(std::abs(model.Shift(k, i) / theta[own]) * std::sqrt(wide.covariance(column, column)));
  }
  out.covariance = sum * wide.covariance * sum.transpose();
  return out;
}

/// By how much theta moves per unit of a parameter known beforehand, between its value and the end of what is
/// likely where the effect's size moves most: sizes are no straight lines of exponents.
std::optional<Eigen::VectorXd> SlopeOver(const Shifting& model, const FreeParameter& parameter, double known,
                                         const Eigen::VectorXd& theta) {
  constexpr double kLikely = 1.7;    // standard deviations: the limits of what is evenly likely between them
  constexpr double kLeastWay = 0.1;  // of a step: what the limits leave of it must still show a slope
  const auto& [k, i] = parameter;
  const NonlinearParameter& limits = model.EffectOf(k).nonlinear[i];
  const Eigen::Index own = model.base() + static_cast<int>(k);
  std::optional<Eigen::VectorXd> steepest;
  for (const double by : {-kLikely * known, kLikely * known}) {
    std::vector<double> values = model.Values(k);
    const double before = values[i];
    values[i] = std::clamp(before + by, limits.min, limits.max);
    if (std::abs(values[i] - before) < kLeastWay * std::abs(by)) continue;
    const ExtendedFit fit = model.Fit({{k, values}}, {});
    if (!fit.solved) continue;
    const Eigen::VectorXd slope = (fit.theta - theta) / (values[i] - before);
    if (!steepest || std::abs(slope[own]) > std::abs((*steepest)[own])) steepest = slope;
  }
  return steepest;
}

/// What a parameter known beforehand to `known` adds to the covariance, and its own standard deviation: the
/// strokes' if that is less.
double AddKnown(const Shifting& model, const FreeParameter& parameter, double known,
                const Eigen::VectorXd& theta, Eigen::MatrixXd& covariance) {
  const auto free = FitLeftFree(model, {parameter}, theta);
  const double std = free ? std::min(known, free->std.front()) : known;
  if (const auto slope = SlopeOver(model, parameter, known, theta))
    covariance += std * std * *slope * slope->transpose();
  return std;
}

/// What another value of a constant of a law, which the strokes are not asked for, does to theta and to the
/// effect's nonlinear parameters, which are left free as far as they can be.
struct Moved {
  Eigen::VectorXd theta;
  std::vector<double> nonlinear;
};

std::optional<Moved> MoveConstant(const Shifting& model, std::size_t k, std::size_t constant, bool free,
                                  const Eigen::VectorXd& theta) {
  const std::vector<UncertainConstant>& constants = model.EffectOf(k).constants;
  const std::vector<double>& given = model.Values(k);
  std::vector<double> values = given;
  for (const UncertainConstant& c : constants) values.push_back(c.value);
  values[given.size() + constant] += constants[constant].std;
  Shifting::Shapes beside;
  for (std::size_t i = 0; free && i < given.size(); ++i) {
    beside.push_back({k, values});
    beside.back().second[i] += model.Shift(k, i);
  }
  const ExtendedFit fit = model.Fit({{k, values}}, beside);
  if (!fit.solved) return std::nullopt;
  const Eigen::VectorXd shares = fit.theta.tail(static_cast<Eigen::Index>(beside.size()));
  const Eigen::Index own = model.base() + static_cast<int>(k);
  Moved out{fit.theta.head(theta.size()) - theta, std::vector<double>(given.size(), 0.0)};
  out.theta[own] += shares.sum();
  for (std::size_t i = 0; i < beside.size(); ++i)
    out.nonlinear[i] =
        model.Shift(k, i) * shares[static_cast<Eigen::Index>(i)] / (fit.theta[own] + shares.sum());
  return out;
}

/// Gradient of Effect::implied over theta.
Eigen::RowVectorXd ImpliedGradient(const Shifting& model, std::size_t k, const Eigen::VectorXd& theta) {
  const int own = model.base() + static_cast<int>(k);
  const auto implied = [&](const Eigen::VectorXd& at) {
    return model.EffectOf(k).implied({at.head(model.base()), at[own]});
  };
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(theta.size());
  for (int i = 0; i < theta.size(); ++i) {
    Eigen::VectorXd at = theta;
    const double step = 1e-5 * theta[i];
    if (step == 0) continue;
    at[i] += step;
    gradient[i] = (implied(at) - implied(theta)) / step;
  }
  return gradient;
}

/// (I - D g')^-1, what an error of theta at given tied parameters becomes.
std::optional<Eigen::MatrixXd> Propagation(const Shifting& model, const Eigen::VectorXd& theta) {
  Eigen::MatrixXd loop = Eigen::MatrixXd::Zero(theta.size(), theta.size());
  for (int k = 0; k < model.size(); ++k) {
    if (!model.EffectOf(k).implied) continue;
    const ExtendedFit shifted = model.Fit({{k, Shifted(model, k, 0)}}, {});
    if (!shifted.solved) return std::nullopt;
    loop += (shifted.theta - theta) / model.Shift(k, 0) * ImpliedGradient(model, k, theta);
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(Eigen::MatrixXd::Identity(theta.size(), theta.size()) - loop);
  if (!lu.isInvertible()) return std::nullopt;
  return lu.inverse();
}

bool HasUnknown(const std::vector<FreeParameter>& unknown, std::size_t k) {
  return std::any_of(unknown.begin(), unknown.end(), [&](const FreeParameter& p) { return p.effect == k; });
}

}  // namespace

void WidenByNonlinear(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
                      const WindowSamples& window, std::span<const EffectChoice> choices, ExtendedFit& fit) {
  if (choices.empty() || !fit.solved) return;
  const Eigen::VectorXd widening = fit.widening;
  if (widening.size() > 0) ScaleScatter(widening.cwiseInverse(), fit);
  const Shifting shifting(std::move(model), strokes, window, choices);
  const int base = shifting.base();
  std::vector<double> student;  // what turns a standard error into the std of an effect
  for (std::size_t k = 0; k < fit.effects.size(); ++k) {
    student.push_back(fit.effects[k].std / std::sqrt(fit.covariance(base + k, base + k)));
    fit.effects[k].nonlinear_std.assign(shifting.EffectOf(k).nonlinear.size(), 0.0);
  }
  const std::vector<FreeParameter> unknown = FreeParameters(shifting, false);
  const auto free = FitLeftFree(shifting, unknown, fit.theta);
  const bool determined = free.has_value() || unknown.empty();
  if (free) {
    fit.covariance = free->covariance;
    for (std::size_t j = 0; j < unknown.size(); ++j)
      fit.effects[unknown[j].effect].nonlinear_std[unknown[j].index] =
          student[unknown[j].effect] * free->std[j];
  }
  const auto propagation = Propagation(shifting, fit.theta);
  if (propagation) fit.covariance = *propagation * fit.covariance * propagation->transpose();
  for (const FreeParameter& known : FreeParameters(shifting, true))
    fit.effects[known.effect].nonlinear_std[known.index] =
        AddKnown(shifting, known, shifting.EffectOf(known.effect).nonlinear[known.index].std, fit.theta,
                 fit.covariance);
  for (std::size_t k = 0; k < fit.effects.size(); ++k) {
    for (std::size_t c = 0; c < shifting.EffectOf(k).constants.size(); ++c) {
      auto moved = MoveConstant(shifting, k, c, determined && IsFree(shifting.EffectOf(k)), fit.theta);
      if (!moved) continue;
      if (propagation) moved->theta = *propagation * moved->theta;
      fit.covariance += moved->theta * moved->theta.transpose();
      for (std::size_t i = 0; i < moved->nonlinear.size(); ++i)
        fit.effects[k].nonlinear_std[i] = std::hypot(fit.effects[k].nonlinear_std[i], moved->nonlinear[i]);
    }
    fit.effects[k].std = student[k] * std::sqrt(fit.covariance(base + k, base + k));
    if (!determined && HasUnknown(unknown, k)) {
      fit.effects[k].std = std::numeric_limits<double>::infinity();
      fit.effects[k].nonlinear_std.assign(fit.effects[k].nonlinear_std.size(), fit.effects[k].std);
    }
    if (!shifting.EffectOf(k).implied) continue;
    const Eigen::RowVectorXd gradient = ImpliedGradient(shifting, k, fit.theta);
    fit.effects[k].nonlinear_std[0] =
        student[k] * std::sqrt((gradient * fit.covariance * gradient.transpose())(0, 0));
  }
  if (widening.size() > 0) ScaleScatter(widening, fit);
}

}  // namespace hydroscope
