#include "diagnosis/refine.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "diagnosis/sample_grams.h"

namespace hydroscope {
namespace {

constexpr int kPolishSteps = 6;        ///< of Gauss and Newton
constexpr double kPolishShift = 0.01;  ///< relative, of a value for its slope
constexpr double kPolished = 1e-4;     ///< relative change of a value that is none
constexpr int kScan = 6;         ///< points tried across the bracket, since the error may have several minima
constexpr int kEvaluations = 6;  ///< of Brent's method between the best point's neighbours
constexpr int kBits = 8;         ///< its relative accuracy, 2^-8
constexpr int kImpliedSteps = 8;            ///< between a law's size and the shape it implies
constexpr double kImpliedAccuracy = 0.001;  ///< relative; well below the std of a size that is known
constexpr double kLeastShare = 1e-4;        ///< of its limit: smaller values are not told from it

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

/// Minimum over [low, high]: a scan, then Brent's method between the best point's neighbours. `errors` gives those of several points.
template <typename Errors>
double Minimise(Errors errors, double low, double high, double start) {
  const double step = (high - low) / (kScan + 1);
  std::vector<double> points = {start};
  for (int k = 1; k <= kScan; ++k) points.push_back(low + k * step);
  const std::vector<double> found = errors(points);
  const auto least = std::ranges::min_element(found);
  const double best = points[static_cast<std::size_t>(least - found.begin())], best_error = *least;
  std::uintmax_t evaluations = kEvaluations;
  const auto minimum = boost::math::tools::brent_find_minima(
      [&](double x) { return errors(std::vector<double>{x}).front(); }, std::max(low, best - step),
      std::min(high, best + step), kBits, evaluations);
  return minimum.second < best_error ? minimum.first : best;
}

/// Fits the model with one effect's nonlinear parameters at any values.
class ShapeTrial {
 public:
  ShapeTrial(const ModelStructure& model, std::span<const StrokeStretches> strokes,
             const WindowSamples& window, std::span<const EffectChoice> others, int effect)
      : fixed_(BaseOnly(model)), window_(window), effect_(effect) {
    std::vector<std::vector<double>> values;
    for (const EffectChoice& other : others) {
      const EffectShape& shape = model.effect_shapes[other.effect][other.shape];
      others_.push_back({other.effect, AddShape(fixed_, other.effect, shape.nonlinear, shape.on)});
      values.push_back(shape.nonlinear);
    }
    std::vector<EffectChoice> all = others_;
    all.push_back({effect, -1});
    on_ = CorrectionOf(fixed_, all, values, others.size());
    grams_.emplace(std::make_shared<ModelStructure>(fixed_), strokes, window);
  }

  const std::optional<Correction>& on() const { return on_; }

  ExtendedFit Fit(const std::vector<double>& nonlinear) const {
    const auto [set, choices] = With({nonlinear});
    return set.Fit(choices);
  }
  /// Of each of `points`: ErrorOf.
  std::vector<double> Errors(const std::vector<std::vector<double>>& points) const {
    const auto [set, choices] = With(points);
    std::vector<double> errors;
    for (std::size_t k = 0; k < points.size(); ++k) errors.push_back(ErrorOf(set, choices, k, points[k]));
    return errors;
  }

  /// Least squares over size and values at once, from values close by: with the shapes at shifted values
  /// beside, sizes ds of these are steps of shift ds / size (Gauss-Newton), taken as far as the error falls.
  std::vector<double> Polished(std::vector<double> values) const;

 private:
  /// Strokes of the model with the effect at each of `points`, and choices: the other effects, then one for each point.
  std::pair<StrokeSet, std::vector<EffectChoice>> With(const std::vector<std::vector<double>>& points) const {
    auto trial = std::make_shared<ModelStructure>(fixed_);
    std::vector<EffectChoice> choices = others_;
    for (const std::vector<double>& point : points)
      choices.push_back({effect_, AddShape(*trial, effect_, point, on_)});
    return {StrokeSet(trial, grams_->Of(trial), window_), choices};
  }
  /// Excess ratio on strokes left out with the effect at point `k` alone; what is known of its values beforehand counts as
  /// equations that are missed by as much.
  double ErrorOf(const StrokeSet& set, const std::vector<EffectChoice>& choices, std::size_t k,
                 const std::vector<double>& point) const {
    std::vector<EffectChoice> chosen = others_;
    chosen.push_back(choices[others_.size() + k]);
    const ExtendedFit fit = set.Fit(chosen);
    if (!fit.solved) return std::numeric_limits<double>::max();
    const std::vector<NonlinearParameter>& known = fixed_.effects[effect_]->nonlinear;
    double surprise = 0;
    for (std::size_t i = 0; i < point.size() && i < known.size(); ++i)
      if (known[i].std > 0)
        surprise += std::pow((point[i] - 0.5 * (known[i].min + known[i].max)) / known[i].std, 2);
    return fit.excess_ratio + surprise / set.equations();
  }

  ModelStructure fixed_;
  std::optional<GrowingGrams> grams_;  ///< from `fixed_` on
  WindowSamples window_;
  int effect_;
  std::vector<EffectChoice> others_;
  std::optional<Correction> on_;
};

std::vector<double> ShapeTrial::Polished(std::vector<double> values) const {
  const std::vector<NonlinearParameter>& limits = fixed_.effects[effect_]->nonlinear;
  if (std::any_of(limits.begin(), limits.end(), [](const NonlinearParameter& n) { return n.std > 0; }))
    return values;
  std::vector<double> next = values;
  double error = std::numeric_limits<double>::infinity(), moved = std::numeric_limits<double>::infinity();
  for (int step = 0; step <= kPolishSteps; ++step) {
    std::vector<std::vector<double>> points = {next};
    std::vector<double> shift;
    for (std::size_t i = 0; step < kPolishSteps && i < next.size(); ++i) {
      const double by = kPolishShift * next[i];
      shift.push_back(next[i] + by <= limits[i].max ? by : -by);
      points.push_back(next);
      points.back()[i] += shift[i];
    }
    const auto [set, choices] = With(points);
    const double next_error = ErrorOf(set, choices, 0, next);
    if (!(next_error < error)) return values;
    values = next;
    error = next_error;
    if (moved < kPolished || step == kPolishSteps) return values;
    const ExtendedFit fit = set.Fit(choices);
    if (!fit.solved) return values;
    const Eigen::VectorXd sizes = fit.theta.tail(static_cast<Eigen::Index>(values.size()) + 1);
    moved = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      next[i] = std::clamp(values[i] + shift[i] * sizes[static_cast<Eigen::Index>(i) + 1] / sizes.sum(),
                           limits[i].min, limits[i].max);
      moved = std::max(moved, std::abs(next[i] - values[i]) / std::max(std::abs(values[i]), 1e-300));
    }
  }
  return values;
}

/// Within the admissible range, and not so small that it cannot be told from none.
double WithinLimits(const NonlinearParameter& limits, double x) {
  x = std::clamp(x, limits.min, limits.max);
  return std::abs(x) < kLeastShare * limits.max ? std::copysign(kLeastShare * limits.max, x) : x;
}

/// The value of nonlinear[0] that the fit with it implies: value -> implied(value) until it stays, with the
/// secant of the last two steps, between values that imply more and less than themselves where both are known. Where the data do
/// not pin it down it ends somewhere else than it implies (not consistent).
double SolveImplied(const ShapeTrial& trial, const ModelStructure& model, const Effect& effect,
                    double value) {
  const NonlinearParameter& limits = effect.nonlinear[0];
  const auto implied = [&](double x) -> std::optional<double> {
    const ExtendedFit fit = trial.Fit({x});
    if (!fit.solved) return std::nullopt;
    return effect.implied({fit.theta.head(model.base_count), fit.effects.back().size});
  };
  double x = WithinLimits(limits, value), x_before = 0, miss_before = 0;
  double low = -std::numeric_limits<double>::infinity(), high = -low;  // imply more, less than themselves
  for (int step = 0; step < kImpliedSteps; ++step) {
    const std::optional<double> y = implied(x);
    if (!y) return x;
    const double miss = *y - x;
    if (std::abs(miss) <= kImpliedAccuracy * std::abs(x)) return x;
    double next = *y;
    if (step > 0 && miss != miss_before) {
      const double secant = x - miss * (x - x_before) / (miss - miss_before);
      // The secant may run off where the error is flat; then the plain step is safer.
      if (std::isfinite(secant) && std::abs(secant - x) < 3 * std::abs(miss) + 0.5 * std::abs(x))
        next = secant;
    }
    (miss > 0 ? low : high) = x;
    if (low < high && (next <= low || next >= high)) next = 0.5 * (low + high);
    x_before = x;
    miss_before = miss;
    x = WithinLimits(limits, next);
    if (x == x_before) return x;
  }
  return x;
}

/// The refined shape of these values: one that is there, else a new one.
EffectChoice Keep(ModelStructure& model, int effect, const std::vector<double>& nonlinear,
                  const std::optional<Correction>& on) {
  auto& shapes = model.effect_shapes[effect];
  const auto same = std::find_if(shapes.begin(), shapes.end(), [&](const EffectShape& s) {
    return s.nonlinear == nonlinear && s.on == on;
  });
  const int shape = same != shapes.end() ? static_cast<int>(same - shapes.begin())
                                         : AddShape(model, effect, nonlinear, on);  // moves all of them
  shapes[static_cast<std::size_t>(shape)].refined = true;
  return {effect, shape};
}

/// Values of the nonlinear parameters of all of `choices`, of which those tied to the size agree with it.
std::vector<std::vector<double>> SolveImpliedTogether(const ModelStructure& model,
                                                      std::span<const StrokeStretches> strokes,
                                                      const WindowSamples& window,
                                                      std::span<const EffectChoice> choices) {
  const ModelStructure base = BaseOnly(model);
  const GrowingGrams grams(std::make_shared<ModelStructure>(base), strokes, window);
  std::vector<std::vector<double>> values;
  for (const EffectChoice& c : choices) values.push_back(model.effect_shapes[c.effect][c.shape].nonlinear);
  for (int step = 0; step < kImpliedSteps; ++step) {
    auto trial = std::make_shared<ModelStructure>(base);
    std::vector<EffectChoice> all;
    for (std::size_t k = 0; k < choices.size(); ++k)
      all.push_back({choices[k].effect, AddShape(*trial, choices[k].effect, values[k],
                                                 CorrectionOf(model, choices, values, k))});
    const ExtendedFit fit = StrokeSet(trial, grams.Of(trial), window).Fit(all);
    if (!fit.solved) break;
    bool settled = true;
    std::vector<std::vector<double>> next = values;
    for (std::size_t k = 0; k < choices.size(); ++k) {
      const Effect& effect = *model.effects[choices[k].effect];
      if (!effect.implied) continue;
      const double implied = effect.implied({fit.theta.head(model.base_count), fit.effects[k].size});
      next[k][0] = WithinLimits(effect.nonlinear[0], implied);
      settled = settled && std::abs(next[k][0] - values[k][0]) <= kImpliedAccuracy * std::abs(values[k][0]);
    }
    if (settled) break;
    values = std::move(next);
  }
  return values;
}

}  // namespace

EffectChoice RefineOne(ModelStructure& model, std::span<const StrokeStretches> strokes,
                       const WindowSamples& window, std::span<const EffectChoice> others,
                       const EffectChoice& start) {
  const Effect& effect = *model.effects[start.effect];
  if (effect.grid.empty()) return start;  // its values were searched for, not a grid's
  const ShapeTrial trial(model, strokes, window, others, start.effect);
  std::vector<double> best = model.effect_shapes[start.effect][start.shape].nonlinear;
  if (effect.implied) best = {SolveImplied(trial, model, effect, best[0])};
  for (std::size_t i = 0; !effect.implied && i < effect.nonlinear.size(); ++i) {
    const auto [low, high] = Bracket(effect, i, best[i]);
    const auto along = [&](const std::vector<double>& places) {
      std::vector<std::vector<double>> points(places.size(), best);
      for (std::size_t k = 0; k < places.size(); ++k) points[k][i] = places[k];
      return trial.Errors(points);
    };
    best[i] = Minimise(along, low, high, best[i]);
  }
  if (!effect.implied) best = trial.Polished(best);
  return Keep(model, start.effect, best, trial.on());
}

bool AddImpliedShape(ModelStructure& model, const ExtendedFit& fit) {
  const EffectEstimate& last = fit.effects.back();
  const Effect& effect = *model.effects[last.choice.effect];
  if (!effect.implied || last.consistent) return false;
  const double implied = effect.implied({fit.theta.head(model.base_count), last.size});
  Keep(model, last.choice.effect, {WithinLimits(effect.nonlinear[0], implied)}, {});
  return true;
}

std::vector<EffectChoice> RefineModel(ModelStructure& model, std::span<const StrokeStretches> strokes,
                                      const WindowSamples& window, std::vector<EffectChoice> choices) {
  if (choices.size() > 1) {
    const auto values = SolveImpliedTogether(model, strokes, window, choices);
    for (std::size_t k = 0; k < choices.size(); ++k)
      choices[k] = Keep(model, choices[k].effect, values[k], CorrectionOf(model, choices, values, k));
  }
  for (EffectChoice& choice : choices) {
    const Effect& effect = *model.effects[choice.effect];
    if (effect.nonlinear.empty() || (choices.size() > 1 && effect.implied)) continue;
    std::vector<EffectChoice> others = choices;
    std::erase(others, choice);
    choice = RefineOne(model, strokes, window, others, choice);
  }
  return choices;
}

}  // namespace hydroscope
