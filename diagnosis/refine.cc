#include "diagnosis/refine.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

#include "estimation/stroke_accumulator.h"

namespace hydroscope {
namespace {

constexpr int kSweeps = 2;       ///< over the coordinates, if there are several
constexpr int kScan = 6;         ///< points tried across the bracket, since the error may have several minima
constexpr int kEvaluations = 6;  ///< of Brent's method between the best point's neighbours
constexpr int kBits = 8;         ///< its relative accuracy, 2^-8

/// Base and output columns alone, no shapes.
ModelStructure BaseOnly(const ModelStructure& model) {
  ModelStructure base = model;
  base.columns.resize(model.output_column() + 1);
  for (auto& shapes : base.effect_shapes) shapes.clear();
  return base;
}

/// From the neighbour below `value` on the effect's grid (or the limit) to the neighbour above.
std::pair<double, double> Bracket(const Effect& effect, std::size_t coordinate, double value) {
  double low = effect.nonlinear[coordinate].min, high = effect.nonlinear[coordinate].max;
  for (const std::vector<double>& point : effect.grid) {
    if (point[coordinate] < value) low = std::max(low, point[coordinate]);
    if (point[coordinate] > value) high = std::min(high, point[coordinate]);
  }
  // A coordinate with one grid value or at the end of the grid: within a factor of three.
  if (value > 0) {
    low = std::max(low, value / 3);
    high = std::min(high, 3 * value);
  }
  return {low, high};
}

/// Minimum of `error` over [low, high]: a scan, then Brent's method between the best point's neighbours.
template <typename Error>
double Minimise(Error error, double low, double high, double start) {
  const double step = (high - low) / (kScan + 1);
  double best = start, best_error = error(start);
  for (int k = 1; k <= kScan; ++k) {
    const double x = low + k * step;
    const double e = error(x);
    if (e < best_error) {
      best_error = e;
      best = x;
    }
  }
  std::uintmax_t evaluations = kEvaluations;
  const auto minimum = boost::math::tools::brent_find_minima(error, std::max(low, best - step), std::min(high, best + step),
                                                             kBits, evaluations);
  return minimum.second < best_error ? minimum.first : best;
}

}  // namespace

std::vector<StrokeGram> GramsOf(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
                                const WindowSamples& window) {
  SpanEquationBuilder builder(model, window);
  StrokeAccumulator accumulator(model->column_count());
  std::vector<StrokeGram> grams;
  Stretch stretch;
  for (const StrokeStretches& stroke : strokes) {
    for (const Stretch& kept : stroke) {
      stretch = kept;
      accumulator.Add(builder.Build(stretch, 0.0));
    }
    grams.push_back(accumulator.Take());
  }
  return grams;
}

std::vector<double> RefineNonlinear(const ModelStructure& model, std::span<const StrokeStretches> strokes,
                                    const WindowSamples& window, std::span<const EffectChoice> others,
                                    const EffectChoice& start) {
  const Effect& effect = *model.effects[start.effect];
  std::vector<double> best = model.effect_shapes[start.effect][start.shape].nonlinear;
  if (effect.nonlinear.empty()) return best;

  ModelStructure fixed = BaseOnly(model);
  std::vector<EffectChoice> choices;
  for (const EffectChoice& other : others) {
    AddShape(fixed, other.effect, model.effect_shapes[other.effect][other.shape].nonlinear);
    choices.push_back({other.effect, static_cast<int>(fixed.effect_shapes[other.effect].size()) - 1});
  }
  const auto error = [&](const std::vector<double>& nonlinear) {
    auto trial = std::make_shared<ModelStructure>(fixed);
    AddShape(*trial, start.effect, nonlinear);
    std::vector<EffectChoice> all = choices;
    all.push_back({start.effect, static_cast<int>(trial->effect_shapes[start.effect].size()) - 1});
    const ExtendedFit fit = StrokeSet(trial, GramsOf(trial, strokes, window), window).Fit(all);
    return fit.solved ? fit.excess_ratio : std::numeric_limits<double>::max();
  };
  const int sweeps = effect.nonlinear.size() > 1 ? kSweeps : 1;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t i = 0; i < effect.nonlinear.size(); ++i) {
      const auto [low, high] = Bracket(effect, i, best[i]);
      const auto along = [&](double x) {
        std::vector<double> trial = best;
        trial[i] = x;
        return error(trial);
      };
      best[i] = Minimise(along, low, high, best[i]);
    }
  return best;
}

}  // namespace hydroscope
