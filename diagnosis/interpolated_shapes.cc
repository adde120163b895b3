#include "diagnosis/interpolated_shapes.h"

#include <algorithm>

namespace hydroscope {
namespace {

EffectShape Between(const EffectShape& low, const EffectShape& high, double share) {
  EffectShape shape;
  shape.columns = low.columns;
  shape.columns.insert(shape.columns.end(), high.columns.begin(), high.columns.end());
  shape.weights = [a = low.weights, b = high.weights, share](const ShapeContext& context) {
    std::vector<double> weights = a(context);
    for (double& w : weights) w *= 1 - share;
    for (const double w : b(context)) weights.push_back(share * w);
    return weights;
  };
  for (std::size_t i = 0; i < low.nonlinear.size(); ++i)
    shape.nonlinear.push_back((1 - share) * low.nonlinear[i] + share * high.nonlinear[i]);
  return shape;
}

/// Index of the only parameter in which two shapes differ, -1 if there are more or none.
int OnlyDifference(const EffectShape& a, const EffectShape& b) {
  int differs = -1;
  for (std::size_t i = 0; i < a.nonlinear.size(); ++i) {
    if (a.nonlinear[i] == b.nonlinear[i]) continue;
    if (differs >= 0) return -1;
    differs = static_cast<int>(i);
  }
  return differs;
}

}  // namespace

void AddInterpolatedShapes(ModelStructure& model, int effect, int parts) {
  std::vector<EffectShape> grid = model.effect_shapes[effect];
  std::stable_sort(grid.begin(), grid.end(),
                   [](const auto& a, const auto& b) { return a.nonlinear < b.nonlinear; });
  for (std::size_t k = 0; k + 1 < grid.size(); ++k)
    for (int part = 1; part < parts && OnlyDifference(grid[k], grid[k + 1]) >= 0; ++part)
      model.effect_shapes[effect].push_back(Between(grid[k], grid[k + 1], static_cast<double>(part) / parts));
}

}  // namespace hydroscope
