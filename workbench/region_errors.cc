#include "workbench/region_errors.h"

#include <algorithm>
#include <cmath>

#include "core/told_error.h"

namespace hydroscope {
namespace {

/// Which rows of StrokeResiduals::signal the ranges are about.
Result<std::vector<int>> SignalsOf(const Region& region, const Residuals& residuals) {
  std::vector<int> rows;
  for (const RegionRange& range : region) {
    const auto found = std::ranges::find_if(residuals.signals,
                                            [&](const ResidualSignal& s) { return s.name == range.signal; });
    if (found == residuals.signals.end())
      return BadInput(Tell("where: there is no signal '{}' to look over",
                           "über '{}' lässt sich nicht auftragen: dieses Signal gibt es nicht",
                           range.signal));
    rows.push_back(static_cast<int>(found - residuals.signals.begin()));
  }
  return rows;
}

bool IsInside(const Region& region, const std::vector<int>& rows, const Residuals& residuals,
              const StrokeResiduals& stroke, int window) {
  for (std::size_t k = 0; k < region.size(); ++k) {
    const ResidualSignal& signal = residuals.signals[rows[k]];
    const double shown = stroke.signal(rows[k], window) * signal.factor + signal.offset;
    if (!(shown >= region[k].from && shown <= region[k].to)) return false;
  }
  return true;
}

}  // namespace

void RegionSums::Add(const RegionSums& other) {
  windows += other.windows;
  error += other.error;
  noise += other.noise;
}
double RegionSums::Rms() const { return std::sqrt(error * (windows > 0 ? 1 / windows : 0)); }
double RegionSums::NoiseRms() const { return std::sqrt(noise * (windows > 0 ? 1 / windows : 0)); }

Result<ErrorsInRegion> ErrorsIn(const Region& region, const Residuals& residuals,
                                std::span<const std::int64_t> strokes,
                                std::span<const ModelledWithEffect> effects) {
  const auto rows = TRY(SignalsOf(region, residuals));
  ErrorsInRegion in;
  for (const ModelledWithEffect& with : effects) in.with_effect.emplace_back(with.effect, 0);
  for (std::size_t s = 0; s < residuals.strokes.size(); ++s) {
    const StrokeResiduals& stroke = residuals.strokes[s];
    RegionSums sums;
    for (int w = 0; w < stroke.windows(); ++w) {
      if (!IsInside(region, rows, residuals, stroke, w)) continue;
      const auto window = static_cast<std::size_t>(w);
      const double error = stroke.measured[window] - stroke.modelled[window];
      sums.Add({1, error * error, stroke.noise_variance[window]});
      for (std::size_t e = 0; e < effects.size(); ++e) {
        const auto& modelled = effects[e].modelled;
        // A signal that the effect needs was bad in this stroke: there it changes nothing.
        const bool known = s < modelled.size() && window < modelled[s].size();
        const double left = known ? stroke.measured[window] - modelled[s][window] : error;
        in.with_effect[e].second += left * left;
      }
    }
    if (sums.windows == 0) continue;
    in.all.Add(sums);
    if (in.by_stroke.empty() || in.by_stroke.back().first != strokes[s])
      in.by_stroke.emplace_back(strokes[s], RegionSums());
    in.by_stroke.back().second.Add(sums);
  }
  std::ranges::sort(in.with_effect, [](const auto& a, const auto& b) { return a.second < b.second; });
  for (auto& [effect, squares] : in.with_effect) squares = std::sqrt(squares / std::max(1.0, in.all.windows));
  return in;
}

}  // namespace hydroscope
