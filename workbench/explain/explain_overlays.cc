#include "workbench/explain/explain_overlays.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnosis/remainder/residuals.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

double RmsError(const StrokeResiduals& stroke) {
  double sum = 0;
  for (int w = 0; w < stroke.windows(); ++w) sum += std::pow(stroke.measured[w] - stroke.modelled[w], 2);
  return stroke.windows() > 0 ? std::sqrt(sum / stroke.windows()) : 0.0;
}

}  // namespace

std::vector<StrokeOverlay> ExplainOverlays(const ExplainResult& result) {
  if (result.log.stretches.empty()) return {};
  const Explanation& x = result.explanation;
  const auto residuals = [&](const ExtendedFit& fit) {
    return ResidualsOf(x.model, result.log.stretches, result.log.window, ColumnWeights(*x.model, fit))
        .strokes;
  };
  const std::vector<StrokeResiduals> base = residuals(x.base), extended = residuals(x.final);
  std::vector<std::size_t> order(base.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](auto a, auto b) { return RmsError(base[a]) < RmsError(base[b]); });
  std::vector<StrokeOverlay> overlays;
  const double step = result.log.window.block * result.log.window.period;
  for (const auto& [s, label] :
       {std::pair(order[order.size() / 2], "median error"), std::pair(order.back(), "largest error")}) {
    const StrokeResiduals& stroke = base[s];
    StrokeOverlay overlay;
    overlay.output = result.log.model->words.output.english;
    overlay.unit = OutputUnit(result.log.machine);
    overlay.sequence = result.log.strokes[s].summary.index;
    overlay.label = label;
    double noise = 0;
    for (int w = 0; w < stroke.windows(); ++w) {
      overlay.time.push_back(w * step);
      noise += stroke.noise_variance[w];
    }
    overlay.measured = stroke.measured;
    overlay.modelled = stroke.modelled;
    if (x.steps.size() > 1) overlay.extended = extended[s].modelled;
    overlay.noise_floor = stroke.windows() > 0 ? std::sqrt(noise / stroke.windows()) : 0;
    if (overlays.empty() || overlays.front().sequence != overlay.sequence)
      overlays.push_back(std::move(overlay));
  }
  return overlays;
}

}  // namespace hydroscope
