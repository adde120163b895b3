#include "diagnosis/shape_freedom.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/contains.h"
#include "diagnosis/effect_ranking.h"

namespace hydroscope {
namespace {

/// The model with `choices`, each at every shape of its grid that the strokes can tell from the others.
CandidateModel AtAllShapes(const StrokeSet& strokes, const std::vector<EffectChoice>& choices) {
  CandidateModel model{choices, strokes.Fit(choices)};
  for (const EffectChoice& choice : choices) {
    const auto grid = static_cast<int>(strokes.model().effects[choice.effect]->grid.size());
    for (int shape = 0; shape < grid; ++shape) {
      if (Contains(model.choices, EffectChoice{choice.effect, shape})) continue;
      std::vector<EffectChoice> more = model.choices;
      more.push_back({choice.effect, shape});
      ExtendedFit fit = strokes.Fit(more);
      if (fit.solved) model = {std::move(more), std::move(fit)};
    }
  }
  return model;
}

/// Whether an effect that was found, other than `k`, is fitted at a shape that its own size contradicts: what
/// such a fit leaves is its own.
bool BesideContradiction(const ModelStructure& model, const Explanation& x, std::size_t k) {
  for (auto j = static_cast<std::size_t>(x.started); j < x.final.effects.size(); ++j) {
    const EffectEstimate& e = x.final.effects[j];
    if (j != k && model.effects[e.choice.effect]->implied && !e.consistent) return true;
  }
  return false;
}

/// Whether effect `k` of the explanation stands out when all others may be any mixture of their shapes.
bool StandsBesideMixtures(const StrokeSet& strokes, const EffectRanking& ranking,
                          const ExplainOptions& options, const Explanation& x,
                          const std::vector<EffectChoice>& others, std::size_t k) {
  const CandidateModel free = AtAllShapes(strokes, others);
  if (free.choices.size() == others.size()) return true;  // nothing is known at several values
  const CandidateModel with = ranking.With(free, x.chosen[k]);
  return with.fit.solved && ranking.Gain(free.fit, with.fit) > options.min_gain &&
         ranking.IsStrong(with.fit.effects.back());
}

}  // namespace

std::vector<std::string> EffectsOfShapes(const StrokeSet& strokes, const Explanation& explanation,
                                         const ExplainOptions& options) {
  struct Resting {
    std::string id;
    double gain;
  };
  const EffectRanking ranking(strokes, options, explanation.base.noise_variance);
  std::vector<Resting> resting;
  const std::vector<EffectChoice>& chosen = explanation.chosen;
  if (explanation.set.empty() || chosen.size() < 2) return {};
  for (auto k = static_cast<std::size_t>(explanation.started); k < chosen.size(); ++k) {
    std::vector<EffectChoice> others = chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (!BesideContradiction(strokes.model(), explanation, k) &&
        StandsBesideMixtures(strokes, ranking, options, explanation, others, k))
      continue;
    const ExtendedFit without = strokes.Fit(others);
    resting.push_back(
        {strokes.model().effects[chosen[k].effect]->id, ranking.Gain(without, explanation.final)});
  }
  const std::size_t found = chosen.size() - static_cast<std::size_t>(explanation.started);
  if (resting.size() == found && found > 1)  // they rest on one another
    resting.erase(std::max_element(resting.begin(), resting.end(),
                                   [](const Resting& a, const Resting& b) { return a.gain < b.gain; }));
  std::vector<std::string> ids;
  for (const Resting& r : resting) ids.push_back(r.id);
  return ids;
}

namespace {

/// The nearest other stored shape of effect `k` of a model in its nonlinear parameter `index`.
struct NextShape {
  std::size_t k, index;
  int shape;
  double distance;  ///< SI of the parameter
};

std::optional<NextShape> FindNextShape(const ModelStructure& model, std::span<const EffectChoice> choices,
                                       std::size_t k, std::size_t index) {
  const auto& shapes = model.effect_shapes[choices[k].effect];
  const auto grid = static_cast<int>(model.effects[choices[k].effect]->grid.size());
  const std::vector<double>& own = shapes[choices[k].shape].nonlinear;
  std::optional<NextShape> next;
  for (int s = 0; s < std::min(grid, static_cast<int>(shapes.size())); ++s) {
    if (shapes[s].nonlinear.size() != own.size()) continue;
    std::vector<double> moved = own;
    moved[index] = shapes[s].nonlinear[index];
    const double distance = moved[index] - own[index];
    if (moved != shapes[s].nonlinear || distance == 0) continue;
    if (!next || std::abs(distance) < std::abs(next->distance)) next = NextShape{k, index, s, distance};
  }
  return next;
}

/// Variances of theta in a fit that has the shapes `beside` as well, sizes added up; nothing where the strokes do not determine it.
std::optional<Eigen::VectorXd> WithFreeShapes(const StrokeSet& strokes, std::span<const EffectChoice> choices,
                                              std::span<const NextShape> beside, Eigen::Index own) {
  std::vector<EffectChoice> wider(choices.begin(), choices.end());
  for (const NextShape& next : beside) wider.push_back({choices[next.k].effect, next.shape});
  const ExtendedFit free = strokes.Fit(wider);
  if (!free.solved || free.theta.size() != own + static_cast<Eigen::Index>(beside.size()))
    return std::nullopt;
  const Eigen::Index base = own - static_cast<Eigen::Index>(choices.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(own, free.theta.size());
  sum.leftCols(own).setIdentity();
  for (std::size_t j = 0; j < beside.size(); ++j)
    sum(base + static_cast<Eigen::Index>(beside[j].k), own + static_cast<Eigen::Index>(j)) = 1;
  return (sum * free.covariance * sum.transpose()).diagonal();
}

/// What is known beforehand of a shape, `std`, moves theta by: variances, or less where the strokes know the shape better.
Eigen::VectorXd ByKnownShape(const StrokeSet& strokes, std::span<const EffectChoice> choices,
                             const NextShape& next, double std, const ExtendedFit& fit) {
  std::vector<EffectChoice> there(choices.begin(), choices.end());
  there[next.k].shape = next.shape;
  const ExtendedFit moved = strokes.Fit(there);
  if (!moved.solved) return Eigen::VectorXd::Zero(fit.theta.size());
  const Eigen::VectorXd by = (std / next.distance * (moved.theta - fit.theta)).array().square();
  const auto free = WithFreeShapes(strokes, choices, {&next, 1}, fit.theta.size());
  return free ? by.cwiseMin((*free - fit.covariance.diagonal()).cwiseMax(0.0)) : by;
}

}  // namespace

void WidenByStoredShapes(const StrokeSet& strokes, std::span<const EffectChoice> choices, ExtendedFit& fit) {
  if (!fit.solved) return;
  const Eigen::VectorXd widening = fit.widening;
  if (widening.size() > 0) ScaleScatter(widening.cwiseInverse(), fit);
  const Eigen::VectorXd given = fit.covariance.diagonal().cwiseMax(1e-300);
  Eigen::VectorXd variance = given;
  std::vector<NextShape> unknown;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    const Effect& effect = *strokes.model().effects[choices[k].effect];
    for (std::size_t i = 0; i < effect.nonlinear.size() && !effect.implied; ++i) {
      const auto next = FindNextShape(strokes.model(), choices, k, i);
      if (!next) continue;
      const double known = effect.nonlinear[i].std;
      if (known > 0)
        variance += ByKnownShape(strokes, choices, *next, known, fit);
      else
        unknown.push_back(*next);
    }
  }
  if (!unknown.empty())
    if (const auto free = WithFreeShapes(strokes, choices, unknown, fit.theta.size()))
      variance += (*free - given).cwiseMax(0.0);
  ScaleScatter((variance.array() / given.array()).sqrt().matrix(), fit);
  if (widening.size() > 0) ScaleScatter(widening, fit);
}

}  // namespace hydroscope
