#include "page/work/region_errors.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/told_error.h"
#include "models/output_unit.h"

namespace hydroscope {
namespace {

/// Sums over the windows of a region.
struct RegionSums {
  double windows = 0, error = 0, noise = 0;  ///< output unit squared

  void Add(const RegionSums& other) {
    windows += other.windows;
    error += other.error;
    noise += other.noise;
  }
  nlohmann::json Json(double factor) const {
    const double share = windows > 0 ? 1 / windows : 0;
    return {{"windows", windows},
            {"rms", std::sqrt(error * share) * factor},
            {"noise", std::sqrt(noise * share) * factor}};
  }
};

/// Which rows of StrokeResiduals::signal the ranges are about.
Result<std::vector<int>> SignalsOf(const Region& region, const Residuals& residuals) {
  std::vector<int> rows;
  for (const RegionRange& range : region) {
    const auto found = std::find_if(residuals.signals.begin(), residuals.signals.end(),
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
    const ResidualSignal& signal = residuals.signals[static_cast<std::size_t>(rows[k])];
    const double shown = stroke.signal(rows[k], window) * signal.factor + signal.offset;
    if (!(shown >= region[k].from && shown <= region[k].to)) return false;
  }
  return true;
}

}  // namespace

void RegionErrors::Take(const CompareResult& compared) {
  strokes_.clear();
  for (const StrokeComparison& stroke : compared.per_stroke) strokes_.push_back(stroke.stroke);
  residuals_ = compared.residuals;
  unit_ = OutputUnit(compared.log.model.get());
}

void RegionErrors::Take(const StatesFit& compared) {
  strokes_.clear();
  effects_.clear();
  for (const StatePiece& piece : compared.fit.pieces) strokes_.push_back(piece.episode);
  residuals_ = compared.located.front().residuals;
  unit_ = compared.located.front().unit;
}

void RegionErrors::Take(const ExplainResult& explained) {
  const Explanation& x = explained.explanation;
  effects_.clear();
  for (const RankedEffect& ranked : x.ranking) {
    if (!ranked.testable || !ranked.fit.solved) continue;
    if (effects_.size() == kMostEffects) break;
    const Residuals residuals = ResidualsOf(x.model, explained.log.stretches, explained.log.window,
                                            ColumnWeights(*x.model, ranked.fit));
    WithEffect with{ranked.id, {}};
    for (const StrokeResiduals& stroke : residuals.strokes) with.modelled.push_back(stroke.modelled);
    effects_.push_back(std::move(with));
  }
}

nlohmann::json RegionErrors::ModelledWith(const std::string& effect, std::int64_t stroke) const {
  const auto with = std::find_if(effects_.begin(), effects_.end(),
                                 [&](const WithEffect& known) { return known.effect == effect; });
  const auto place =
      static_cast<std::size_t>(std::find(strokes_.begin(), strokes_.end(), stroke) - strokes_.begin());
  if (with == effects_.end() || place >= std::min(strokes_.size(), with->modelled.size())) return nullptr;
  const std::vector<double>& modelled = with->modelled[place];
  if (modelled.size() != residuals_.strokes[place].modelled.size()) return nullptr;
  nlohmann::json shown = nlohmann::json::array();
  for (const double value : modelled) shown.push_back(value * unit_.factor);
  return shown;
}

Result<nlohmann::json> RegionErrors::In(const Region& region) const {
  if (residuals_.strokes.empty()) return nlohmann::json();
  const auto rows = SignalsOf(region, residuals_);
  if (!rows) return tl::unexpected(rows.error());
  RegionSums all;
  std::vector<std::pair<std::int64_t, RegionSums>> by_stroke;
  std::vector<double> with_effect(effects_.size(), 0);
  for (std::size_t s = 0; s < residuals_.strokes.size(); ++s) {
    const StrokeResiduals& stroke = residuals_.strokes[s];
    RegionSums sums;
    for (int w = 0; w < stroke.windows(); ++w) {
      if (!IsInside(region, *rows, residuals_, stroke, w)) continue;
      const auto window = static_cast<std::size_t>(w);
      const double error = stroke.measured[window] - stroke.modelled[window];
      sums.Add({1, error * error, stroke.noise_variance[window]});
      for (std::size_t e = 0; e < effects_.size(); ++e) {
        const auto& modelled = effects_[e].modelled;
        // A signal that the effect needs was bad in this stroke: there it changes nothing.
        const bool known = s < modelled.size() && window < modelled[s].size();
        const double left = known ? stroke.measured[window] - modelled[s][window] : error;
        with_effect[e] += left * left;
      }
    }
    if (sums.windows == 0) continue;
    all.Add(sums);
    if (by_stroke.empty() || by_stroke.back().first != strokes_[s])
      by_stroke.emplace_back(strokes_[s], RegionSums());
    by_stroke.back().second.Add(sums);
  }
  nlohmann::json strokes = nlohmann::json::array(), effects = nlohmann::json::array();
  for (const auto& [stroke, sums] : by_stroke) {
    strokes.push_back(sums.Json(unit_.factor));
    strokes.back()["stroke"] = stroke;
  }
  std::vector<std::size_t> order(effects_.size());
  for (std::size_t e = 0; e < order.size(); ++e) order[e] = e;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return with_effect[a] < with_effect[b]; });
  for (const std::size_t e : order)
    effects.push_back({{"effect", effects_[e].effect},
                       {"rms", std::sqrt(with_effect[e] / std::max(1.0, all.windows)) * unit_.factor}});
  nlohmann::json out = all.Json(unit_.factor);
  out.update({{"unit", unit_.name}, {"strokes", std::move(strokes)}, {"effects", std::move(effects)}});
  return out;
}

}  // namespace hydroscope
