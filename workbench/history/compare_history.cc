#include <algorithm>
#include <cmath>

#include "core/non_negative.h"
#include "workbench/compare_log.h"
#include "workbench/explain/explain_history.h"
#include "workbench/model/model_record.h"

namespace hydroscope {
namespace {

double QuadraticForm(const SymmetricMatrix& gram, const Eigen::VectorXd& weights) {
  double sum = 0;
  for (int i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    for (int j = 0; j < weights.size(); ++j)  // of what does not count, a signal may have been bad
      if (weights[j] != 0) sum += weights[i] * weights[j] * gram(i, j);
  }
  return NonNegative(sum);
}

/// Errors of one group of strokes, NaN where a signal that an effect needs was bad; `modelled` are the model's column weights.
StrokeComparison Compare(const StrokeGram& gram, const Eigen::VectorXd& modelled, const ModelStructure& model,
                         const WindowSamples& window) {
  StrokeComparison out;
  const int output = model.output_column();
  const double windows = static_cast<double>(gram.windows);
  out.windows = static_cast<int>(gram.windows);
  if (windows <= 0 || gram.blocks <= gram.spans) return out;
  Eigen::VectorXd residual = -modelled;
  residual[output] += 1;
  out.rms_measured = std::sqrt(gram.flow(output, output) / windows);
  out.rms_modelled = std::sqrt(QuadraticForm(gram.flow, modelled) / windows);
  out.rms_residual = std::sqrt(QuadraticForm(gram.flow, residual) / windows);
  std::vector<int> columns, walking;
  for (int c = 0; c < modelled.size(); ++c) {
    if (modelled[c] == 0 || c == output) continue;
    if (model.columns[c].walks) walking.push_back(static_cast<int>(columns.size()));
    columns.push_back(c);
  }
  if (model.columns[output].walks) walking.push_back(static_cast<int>(columns.size()));
  out.noise_floor = NoiseFloor({&gram, 1}, columns, output, modelled(columns).eval(), window, walking);
  return out;
}

/// Begin of a single stroke in the time of its log; NaN for a group, or a stroke whose summary was not read.
double BeginOf(const StrokeHistory& history, const HistoryPart& unit) {
  for (const StrokeSummary& summary : history.sample)
    if (unit.strokes() == 1 && summary.index == unit.first && history.parts.size() == 1) return summary.begin;
  return std::nan("");
}

}  // namespace

Result<CompareResult> CompareHistory(const StrokeHistory& history) {
  CompareResult out;
  out.model = TRY(FitHistoryModel(history.machine, history));
  out.log.machine = history.machine;
  out.log.model = history.model;
  out.log.window = history.window;
  out.strokes = static_cast<std::size_t>(history.strokes());
  if (history.units.size() >= kMinExplainStrokes)
    if (auto explained = ExplainHistoryButForOdd(history)) {
      const Explanation& x = explained->explanation;
      if (!x.odd_strokes.empty()) {
        out.log.strokes = std::move(explained->log.strokes);
        TakeModelOfTheRest(x, out.model);
        out.model.figures = explained->base;
      }
      TakeVerdict(x, out);
      if (history.noise_scale != 1) out.model.figures.noise_floor = explained->base.noise_floor;
    }
  const Eigen::VectorXd weights = ColumnWeights(*out.model.structure, out.model.fit);
  for (std::size_t k = 0; k < history.units.size(); ++k) {
    const StrokeGram& unit = history.units[k];
    out.per_stroke.push_back(Compare(unit, weights, *history.model, history.window));
    out.per_stroke.back().noise_floor = std::sqrt(history.floor_scale.value_or(history.noise_scale)) *
                                        history.NoiseFloor(out.per_stroke.back().noise_floor);
    out.per_stroke.back().stroke = history.unit_parts[k].first;
    out.per_stroke.back().begin = BeginOf(history, history.unit_parts[k]);
  }
  out.overall = OverallOf(out.model.figures);
  const std::vector<std::size_t> odd = IndicesOf(out.odd);
  for (std::size_t k = 0; k < out.per_stroke.size(); ++k)
    if (!std::ranges::binary_search(odd, k)) out.overall.windows += out.per_stroke[k].windows;
  return out;
}

}  // namespace hydroscope
