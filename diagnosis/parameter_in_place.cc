#include "diagnosis/parameter_in_place.h"

#include <algorithm>
#include <vector>

#include "diagnosis/remainder/residuals.h"

namespace hydroscope {
namespace {

/// Of the model's error in strokes of which `gram` is the sum: the energy that one of `directions` (columns), of any sizes, leaves.
double LeftOf(const Eigen::MatrixXd& gram, const Eigen::VectorXd& error, const Eigen::MatrixXd& directions) {
  const double energy = error.dot(gram * error);
  if (directions.cols() == 0) return energy;
  const Eigen::VectorXd together = directions.transpose() * (gram * error);
  const NormalEquations equations{directions.transpose() * gram * directions, together, 0, 0};
  const Eigen::VectorXd sizes = SolveNormalEquations(equations);
  return sizes.size() == 0 ? energy : energy - sizes.dot(together);
}

/// What the effects of `found` that the rest does not have may leave, by size.
Eigen::MatrixXd DirectionsOf(const Explanation& found, const StrokeSet& odd, const ExtendedFit& rest) {
  const ModelStructure& model = odd.model();
  Eigen::MatrixXd directions(model.column_count(), 0);
  for (const EffectEstimate& effect : found.final.effects) {
    if (std::ranges::any_of(rest.effects, [&](const auto& e) { return e.choice == effect.choice; })) continue;
    Eigen::VectorXd at(model.base_count + 1);
    at << rest.theta.head(model.base_count), effect.size;
    directions.conservativeResize(Eigen::NoChange, directions.cols() + 1);
    directions.rightCols(1) = odd.Direction(effect.choice, at);
  }
  return directions;
}

}  // namespace

Eigen::MatrixXd MovesOf(const ModelStructure& model, std::span<const DerivedParameter> derived) {
  Eigen::MatrixXd gradients(static_cast<Eigen::Index>(derived.size()), model.base_count);
  for (std::size_t p = 0; p < derived.size(); ++p)
    gradients.row(static_cast<Eigen::Index>(p)) = derived[p].gradient.transpose();
  // Parameters of different units: each row by itself.
  const Eigen::VectorXd scale = gradients.rowwise().norm().cwiseMax(1e-300).cwiseInverse();
  Eigen::MatrixXd moves =
      Eigen::MatrixXd::Zero(model.column_count(), static_cast<Eigen::Index>(derived.size()));
  moves.topRows(model.base_count) =
      (scale.asDiagonal() * gradients).completeOrthogonalDecomposition().pseudoInverse();
  return moves;
}

ParameterInPlace ParameterInPlaceOf(const Explanation& found, bool explains, const StrokeSet& odd,
                                    const ExtendedFit& rest, const ExplainOptions& explain,
                                    const OddStrokeOptions& options) {
  const ModelStructure& model = odd.model();
  const Eigen::VectorXd error = ErrorWeights(model, rest);
  const Eigen::MatrixXd gram = odd.Total();
  const std::vector<Eigen::MatrixXd> gram_of_each = odd.TotalOfEach();

  const double whole = error.dot(gram * error),
               by_effects = LeftOf(gram, error, DirectionsOf(found, odd, rest));
  const double floor = explain.floor_excess * rest.noise_variance * odd.equations();
  const double alike = by_effects + std::max(options.beyond_parameter * rest.noise_variance,
                                             options.beyond_share * (whole - by_effects));
  const double enough = explains ? std::min(floor, alike) : floor;

  const std::vector<DerivedParameter> derived = model.derive(rest.theta.head(model.base_count));
  const Eigen::MatrixXd moves = MovesOf(model, derived);
  ParameterInPlace best;
  double least = enough, least_by_each = enough;
  for (std::size_t p = 0; p < derived.size(); ++p) {
    const auto move = moves.col(static_cast<Eigen::Index>(p));
    const double left = LeftOf(gram, error, move);
    if (left < least) best.by_one = derived[p].name, least = left;
    double left_by_each = 0;
    for (const Eigen::MatrixXd& of_one : gram_of_each) left_by_each += LeftOf(of_one, error, move);
    if (left_by_each < least_by_each) best.by_each = derived[p].name, least_by_each = left_by_each;
  }
  return best;
}

}  // namespace hydroscope
