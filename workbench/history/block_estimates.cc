#include "workbench/history/block_estimates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/non_negative.h"
#include "diagnosis/extended_fit.h"
#include "workbench/history/stroke_history.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

constexpr std::int64_t kBlocks = 40;        ///< aimed at
constexpr std::int64_t kMostSingle = 1024;  ///< strokes read one by one

/// Consecutive units of a history: begin <= index < end.
struct UnitRange {
  std::size_t begin, end;
};

/// As many units in each as it takes for kBlocks blocks of kLeastBlockStrokes strokes or more; the rest joins
/// the last.
std::vector<UnitRange> Cut(const StrokeHistory& history) {
  const std::int64_t total = history.strokes();
  const std::int64_t least = std::max(kLeastBlockStrokes, total / kBlocks);
  std::vector<UnitRange> blocks;
  std::size_t begin = 0;
  std::int64_t strokes = 0;
  for (std::size_t k = 0; k < history.units.size(); ++k) {
    strokes += history.unit_parts[k].strokes();
    if (strokes < least) continue;
    blocks.push_back({begin, k + 1});
    begin = k + 1;
    strokes = 0;
  }
  if (!blocks.empty()) blocks.back().end = history.units.size();
  return blocks;
}

/// Effects in the shapes that suit the whole record best, behind the columns of `structure`.
struct ShapedEffects {
  std::shared_ptr<const ModelStructure> structure;
  std::vector<EffectChoice> choices;
};

Result<ShapedEffects> ChooseShapes(const Machine& machine, const StrokeHistory& history) {
  if (machine.added_effects.empty()) return ShapedEffects{history.model, {}};
  auto fitted = TRY(FitHistoryModel(machine, history));
  return ShapedEffects{std::move(fitted.structure), std::move(fitted.choices)};
}

double RandomStd(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& gradient, double factor) {
  return factor * std::sqrt(NonNegative(gradient.dot(covariance * gradient)));
}

std::vector<Estimate> Parameters(const ModelStructure& model, const ExtendedFit& fit, std::size_t units) {
  std::vector<Estimate> out;
  const double factor =
      units > 1 ? StudentFactor(static_cast<double>(units) - 1) : std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd covariance = fit.covariance.topLeftCorner(model.base_count, model.base_count);
  for (const DerivedParameter& derived : model.derive(fit.theta.head(model.base_count))) {
    Estimate estimate;
    estimate.parameter = derived.name;
    estimate.value = derived.value;
    estimate.std = RandomStd(covariance, derived.gradient, factor);
    estimate.reason = derived.admissible ? EstimateReason::kUpdated : EstimateReason::kOutsidePhysics;
    out.push_back(std::move(estimate));
  }
  for (const EffectEstimate& effect : fit.effects) {
    const Effect& law = *model.effects[effect.choice.effect];
    Estimate estimate;
    estimate.parameter = law.id + "." + law.parameter;
    estimate.value = effect.size;
    estimate.std = units > 1 ? effect.std : std::numeric_limits<double>::quiet_NaN();
    estimate.reason = EstimateReason::kUpdated;
    out.push_back(std::move(estimate));
  }
  return out;
}

/// Means over the strokes from `first` up to, not including, `last`.
void SetMeans(const std::vector<StrokeSummary>& strokes, std::int64_t first, std::int64_t last,
              BlockEstimates& block) {
  const auto from = std::ranges::lower_bound(strokes, first, {}, &StrokeSummary::index);
  const auto mean = [&](auto value) {
    double sum = 0, count = 0;
    for (auto stroke = from; stroke != strokes.end() && stroke->index < last; ++stroke)
      if (std::isfinite(value(*stroke))) sum += value(*stroke), ++count;
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  };
  block.oil_temperature = mean([](const StrokeSummary& s) { return s.oil_temperature; });
  for (std::size_t k = 0; k < block.conditions.size(); ++k)
    block.conditions[k] = mean([k](const StrokeSummary& s) { return s.conditions[k]; });
}

}  // namespace

Result<std::vector<BlockEstimates>> EstimateBlocks(const Database& database, std::int64_t machine_id,
                                                   const Machine& machine,
                                                   const std::vector<StrokeSummary>& strokes) {
  std::vector<BlockEstimates> blocks;
  if (strokes.empty()) return blocks;
  const HistoryPart all{machine.name, machine_id, strokes.front().index, strokes.back().index + 1};
  const auto history = TRY(LoadHistory(database, "", {all}, machine, kMostSingle));
  const auto shapes = TRY(ChooseShapes(machine, history));
  for (const UnitRange& range : Cut(history)) {
    const std::span<const StrokeGram> units(&history.units[range.begin], range.end - range.begin);
    const ExtendedFit fit =
        StrokeSet(shapes.structure, {units.begin(), units.end()}, history.window).Fit(shapes.choices);
    if (!fit.solved) continue;
    BlockEstimates block;
    block.first = history.unit_parts[range.begin].first;
    block.last = history.unit_parts[range.end - 1].last;
    SetMeans(strokes, block.first, block.last, block);
    block.error = fit.fit_excess_ratio;
    block.parameters = Parameters(*shapes.structure, fit, units.size());
    blocks.push_back(std::move(block));
  }
  return blocks;
}

}  // namespace hydroscope
