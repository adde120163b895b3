#include "diagnosis/refine.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

#include "estimation/stroke_accumulator.h"

namespace hydroscope {
namespace {

constexpr int kSweeps = 2;              ///< over the coordinates, if there are several
constexpr int kEvaluations = 9;         ///< per coordinate and sweep
constexpr int kBits = 8;                ///< relative accuracy of Brent's method, 2^-8

/// Base and output columns alone, no shapes.
ModelStructure BaseOnly(const ModelStructure& model) {
  ModelStructure base = model;
  base.columns.resize(model.output_column() + 1);
  for (auto& shapes : base.effect_shapes) shapes.clear();
  return base;
}

/// How far a search around `value` goes: half the admissible range on a scale that fits the parameter.
std::pair<double, double> Bracket(const NonlinearParameter& parameter, double value, double reach) {
  if (parameter.min > 0 && parameter.max / parameter.min > 20) {
    const double factor = std::exp(reach * std::log(parameter.max / parameter.min));
    return {std::max(parameter.min, value / factor), std::min(parameter.max, value * factor)};
  }
  const double width = reach * (parameter.max - parameter.min);
  return {std::max(parameter.min, value - width), std::min(parameter.max, value + width)};
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
      const auto [low, high] = Bracket(effect.nonlinear[i], best[i], sweep == 0 ? 0.2 : 0.08);
      std::vector<double> trial = best;
      std::uintmax_t evaluations = kEvaluations;
      const auto minimum = boost::math::tools::brent_find_minima(
          [&](double x) {
            trial[i] = x;
            return error(trial);
          },
          low, high, kBits, evaluations);
      best[i] = minimum.first;
    }
  return best;
}

}  // namespace hydroscope
