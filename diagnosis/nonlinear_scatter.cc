#include "diagnosis/nonlinear_scatter.h"

#include <cmath>
#include <optional>
#include <vector>

namespace hydroscope {
namespace {

constexpr double kShift = 0.02;  ///< of a nonlinear parameter, relative: far enough to be told from it

/// The effects of a fit, one of them at other values of its nonlinear parameters.
class Shifting {
 public:
  Shifting(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
           const WindowSamples& window, std::span<const EffectChoice> choices)
      : model_(std::move(model)), strokes_(strokes), window_(window), choices_(choices) {}

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

  /// Fit of base and effects with further shapes beside, or in place of those of `k`.
  ExtendedFit Fit(const std::vector<std::pair<std::size_t, std::vector<double>>>& shapes, bool beside) const {
    auto model = std::make_shared<ModelStructure>(*model_);
    std::vector<EffectChoice> choices(choices_.begin(), choices_.end());
    for (const auto& [k, values] : shapes) {
      const int effect = choices_[k].effect;
      const EffectChoice shifted{
          effect, AddShape(*model, effect, values, model->effect_shapes[effect][choices_[k].shape].on)};
      if (beside)
        choices.push_back(shifted);
      else
        choices[k] = shifted;
    }
    return StrokeSet(model, GramsOf(model, strokes_, window_), window_).Fit(choices);
  }

 private:
  std::shared_ptr<const ModelStructure> model_;
  std::span<const StrokeStretches> strokes_;
  WindowSamples window_;
  std::span<const EffectChoice> choices_;
};

std::vector<double> Shifted(const Shifting& model, std::size_t k, std::size_t i) {
  std::vector<double> values = model.Values(k);
  values[i] += model.Shift(k, i);
  return values;
}

/// Covariance with the free nonlinear parameters left free; empty without any.
std::optional<Eigen::MatrixXd> CovarianceLeftFree(const Shifting& model, Eigen::Index kept) {
  std::vector<std::pair<std::size_t, std::vector<double>>> shapes;
  for (int k = 0; k < model.size(); ++k)
    for (std::size_t i = 0; !model.EffectOf(k).implied && i < model.Values(k).size(); ++i)
      shapes.push_back({k, Shifted(model, k, i)});
  if (shapes.empty()) return std::nullopt;
  const ExtendedFit wide = model.Fit(shapes, true);
  if (!wide.solved) return std::nullopt;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(kept, wide.theta.size());
  for (std::size_t j = 0; j < shapes.size(); ++j)
    sum(model.base() + static_cast<int>(shapes[j].first), kept + static_cast<int>(j)) = 1;
  return sum * wide.covariance * sum.transpose();
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
    const ExtendedFit shifted = model.Fit({{k, Shifted(model, k, 0)}}, false);
    if (!shifted.solved) return std::nullopt;
    loop += (shifted.theta - theta) / model.Shift(k, 0) * ImpliedGradient(model, k, theta);
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(Eigen::MatrixXd::Identity(theta.size(), theta.size()) - loop);
  if (!lu.isInvertible()) return std::nullopt;
  return lu.inverse();
}

}  // namespace

void WidenByNonlinear(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
                      const WindowSamples& window, std::span<const EffectChoice> choices, ExtendedFit& fit) {
  const Shifting shifting(std::move(model), strokes, window, choices);
  const int base = shifting.base();
  std::vector<double> student;  // what turns a standard error into the std of an effect
  for (std::size_t k = 0; k < fit.effects.size(); ++k)
    student.push_back(fit.effects[k].std / std::sqrt(fit.covariance(base + k, base + k)));
  if (const auto free = CovarianceLeftFree(shifting, fit.theta.size())) fit.covariance = *free;
  if (const auto propagation = Propagation(shifting, fit.theta))
    fit.covariance = *propagation * fit.covariance * propagation->transpose();
  for (std::size_t k = 0; k < fit.effects.size(); ++k)
    fit.effects[k].std = student[k] * std::sqrt(fit.covariance(base + k, base + k));
}

}  // namespace hydroscope
