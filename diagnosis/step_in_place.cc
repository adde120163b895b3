#include "diagnosis/step_in_place.h"

#include <algorithm>
#include <vector>

#include "diagnosis/parameter_in_place.h"
#include "diagnosis/remainder/residuals.h"

namespace hydroscope {
namespace {

/// The base model's parameters and the effects' sizes, a column each, as combinations of the model's columns at `fit`.
Eigen::MatrixXd FreeDirections(const StrokeSet& strokes, const ExtendedFit& fit) {
  const ModelStructure& model = strokes.model();
  const Eigen::Index base = model.base_count, effects = static_cast<Eigen::Index>(fit.effects.size());
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(model.column_count(), base + effects);
  directions.topLeftCorner(base, base).setIdentity();
  for (Eigen::Index k = 0; k < effects; ++k) {
    const EffectEstimate& effect = fit.effects[static_cast<std::size_t>(k)];
    Eigen::VectorXd at(base + 1);
    at << fit.theta.head(base), effect.size;
    directions.col(base + k) = strokes.Direction(effect.choice, at);
  }
  return directions;
}

}  // namespace

std::optional<StepInPlace> StepInPlaceOf(const StrokeSet& strokes, const Explanation& found, std::size_t at,
                                         const Effect& drift) {
  const ModelStructure& model = strokes.model();
  std::vector<EffectChoice> others = found.chosen;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(at));
  const std::vector<std::size_t> usable = strokes.Usable(found.chosen);
  const StrokeSet used = strokes.Only(usable);
  const ExtendedFit without = used.Fit(others), with = used.Fit(found.chosen);
  if (!without.solved || !with.solved) return std::nullopt;
  const std::vector<DerivedParameter> derived = model.derive(without.theta.head(model.base_count));
  const auto parameter = std::ranges::find(derived, drift.drifting.english, &DerivedParameter::name);
  if (parameter == derived.end()) return std::nullopt;

  const Eigen::VectorXd error = ErrorWeights(model, without), as_chosen = ErrorWeights(model, with);
  const Eigen::MatrixXd free = FreeDirections(strokes, without);
  const Eigen::VectorXd move = MovesOf(model, derived).col(parameter - derived.begin());
  const Eigen::MatrixXd whole = used.Total();
  const std::vector<Eigen::MatrixXd> of_each = used.TotalOfEach();

  const Eigen::Index count = free.cols();
  NormalEquations equations{Eigen::MatrixXd::Zero(count + 1, count + 1), Eigen::VectorXd::Zero(count + 1), 0,
                            0};
  equations.h.topLeftCorner(count, count) = free.transpose() * whole * free;
  equations.g.head(count) = free.transpose() * (whole * error);
  double least = as_chosen.dot(whole * as_chosen);
  std::optional<StepInPlace> best;
  Eigen::MatrixXd after = Eigen::MatrixXd::Zero(whole.rows(), whole.cols());
  for (std::size_t first = of_each.size() - 1; first > 0; --first) {
    after += of_each[first];
    equations.h.col(count).head(count) = free.transpose() * (after * move);
    equations.h.row(count).head(count) = equations.h.col(count).head(count).transpose();
    equations.h(count, count) = move.dot(after * move);
    equations.g[count] = move.dot(after * error);
    const Eigen::VectorXd sizes = SolveNormalEquations(equations);
    if (sizes.size() == 0) continue;
    const double left = error.dot(whole * error) - sizes.dot(equations.g);
    if (left < least) best = StepInPlace{parameter->name, usable[first]}, least = left;
  }
  return best;
}

}  // namespace hydroscope
