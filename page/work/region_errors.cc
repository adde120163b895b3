#include "page/work/region_errors.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "models/output_unit.h"

namespace hydroscope {

void RegionErrors::Take(const CompareResult& compared) {
  strokes_.clear();
  for (const StrokeComparison& stroke : compared.per_stroke) strokes_.push_back(stroke.stroke);
  residuals_ = compared.residuals;
  ShowIn(OutputUnit(compared.log.machine));
}

void RegionErrors::Take(const StatesFit& compared) {
  strokes_.clear();
  effects_.clear();
  for (const StatePiece& piece : compared.fit.pieces) strokes_.push_back(piece.episode);
  residuals_ = compared.located.front().residuals;
  ShowIn(compared.located.front().unit);
}

void RegionErrors::Take(const ExplainResult& explained) {
  const Explanation& x = explained.explanation;
  effects_.clear();
  for (const RankedEffect& ranked : x.ranking) {
    if (!ranked.testable || !ranked.fit.solved) continue;
    if (effects_.size() == kMostEffects) break;
    const Residuals residuals = ResidualsOf(x.model, explained.log.stretches, explained.log.window,
                                            ColumnWeights(*x.model, ranked.fit));
    ModelledWithEffect with{ranked.id, {}};
    for (const StrokeResiduals& stroke : residuals.strokes) with.modelled.push_back(stroke.modelled);
    effects_.push_back(std::move(with));
  }
}

nlohmann::json RegionErrors::ModelledWith(const std::string& effect, std::int64_t stroke) const {
  const auto with = std::find_if(effects_.begin(), effects_.end(),
                                 [&](const ModelledWithEffect& known) { return known.effect == effect; });
  const auto place =
      static_cast<std::size_t>(std::find(strokes_.begin(), strokes_.end(), stroke) - strokes_.begin());
  if (with == effects_.end() || place >= std::min(strokes_.size(), with->modelled.size())) return nullptr;
  const std::vector<double>& modelled = with->modelled[place];
  if (modelled.size() != residuals_.strokes[place].modelled.size()) return nullptr;
  nlohmann::json shown = nlohmann::json::array();
  for (const double value : modelled) shown.push_back(value * factor_);
  return shown;
}

Result<nlohmann::json> RegionErrors::In(const Region& region) const {
  if (residuals_.strokes.empty()) return nlohmann::json();
  const auto errors = TRY(ErrorsIn(region, residuals_, strokes_, effects_));
  const auto json_of = [&](const RegionSums& sums) -> nlohmann::json {
    return {{"windows", sums.windows}, {"rms", sums.Rms() * factor_}, {"noise", sums.NoiseRms() * factor_}};
  };
  nlohmann::json strokes = nlohmann::json::array(), effects = nlohmann::json::array();
  for (const auto& [stroke, sums] : errors.by_stroke) {
    strokes.push_back(json_of(sums));
    strokes.back()["stroke"] = stroke;
  }
  for (const auto& [effect, rms] : errors.with_effect)
    effects.push_back({{"effect", effect}, {"rms", rms * factor_}});
  nlohmann::json out = json_of(errors.all);
  out.update({{"unit", unit_}, {"strokes", std::move(strokes)}, {"effects", std::move(effects)}});
  return out;
}

}  // namespace hydroscope
