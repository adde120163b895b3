#include "diagnosis/hidden_bias.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace hydroscope {
namespace {

/// Share of the effect's regressor that the model cannot take over, below which the effect is all but part of it.
constexpr double kMimicked = 0.05;
/// Error energy over noise energy that stays unseen: 7 % of the error, half of what `fit` warns of.
constexpr double kUnseen = 0.15;
/// A bias below this share of the value (of a number without unit: absolute) matters to nobody.
constexpr double kMatters = 0.02, kNumberMatters = 0.005;

bool IsAdded(const ExtendedFit& fit, int effect) {
  return std::any_of(fit.effects.begin(), fit.effects.end(),
                     [&](const EffectEstimate& e) { return e.choice.effect == effect; });
}

}  // namespace

Eigen::MatrixXd ModelDirections(const StrokeSet& strokes, const ExtendedFit& fit) {
  const ModelStructure& model = strokes.model();
  const int base = model.base_count, added = static_cast<int>(fit.effects.size());
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(model.column_count(), base + added);
  directions.topLeftCorner(base, base).setIdentity();
  for (int k = 0; k < added; ++k) {
    Eigen::VectorXd theta(base + 1);
    theta << fit.theta.head(base), fit.effects[k].size;
    directions.col(base + k) = strokes.Direction(fit.effects[k].choice, theta);
  }
  return directions;
}

std::vector<HiddenBias> HiddenBiases(const StrokeSet& strokes, const ExtendedFit& fit) {
  std::vector<HiddenBias> out;
  const ModelStructure& model = strokes.model();
  const int base = model.base_count;
  const Eigen::MatrixXd total = strokes.Total();
  const Eigen::MatrixXd directions = ModelDirections(strokes, fit);
  const NormalEquations own{directions.transpose() * total * directions, {}, 0, 0};
  const double noise = fit.noise_variance * strokes.equations();
  const std::vector<DerivedParameter> derived = model.derive(fit.theta.head(base));
  for (int e = 0; e < static_cast<int>(model.effects.size()); ++e) {
    const Effect& effect = *model.effects[e];
    const EffectChoice choice{e, 0};
    if (IsAdded(fit, e) || !effect.nonlinear.empty() || !std::isfinite(effect.typical) ||
        !strokes.Measured(choice))
      continue;
    Eigen::VectorXd theta(base + 1);
    theta << fit.theta.head(base), effect.typical;
    const Eigen::VectorXd direction = strokes.Direction(choice, theta);
    NormalEquations equations = own;
    equations.g = directions.transpose() * (total * direction);
    const Eigen::VectorXd taken = SolveNormalEquations(equations);
    const double energy = direction.dot(total * direction);
    if (taken.size() == 0 || !(energy > 0)) continue;
    const double left = energy - taken.dot(equations.g);
    for (std::size_t p = 0; p < derived.size(); ++p)
      out.push_back({e, static_cast<int>(p), derived[p].gradient.dot(taken.head(base)) * effect.typical,
                     std::clamp(left / energy, 0.0, 1.0), left * effect.typical * effect.typical / noise});
  }
  return out;
}

std::vector<HiddenBias> ConfoundedBiases(const StrokeSet& strokes, const ExtendedFit& fit,
                                         std::span<const Estimate> parameters) {
  std::vector<HiddenBias> out = HiddenBiases(strokes, fit);
  std::erase_if(out, [&](const HiddenBias& b) {
    const Estimate& e = parameters[static_cast<std::size_t>(b.parameter)];
    const double matters = e.unit == "1" ? kNumberMatters : kMatters * std::abs(e.value);
    return !(std::abs(b.bias) > std::max(matters, kNormal95 * e.std)) || b.independent > kMimicked ||
           b.excess_ratio > kUnseen;
  });
  std::stable_sort(out.begin(), out.end(), [](const HiddenBias& a, const HiddenBias& b) {
    return a.parameter != b.parameter ? a.parameter < b.parameter : std::abs(a.bias) > std::abs(b.bias);
  });
  return out;
}

}  // namespace hydroscope
