#include "diagnosis/effect_swap.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/subset_search.h"

namespace hydroscope {
namespace {

const ExplainOptions kLimits;

/// Over its std by strokes: an effect of the model as it is is still seen beside what was found.
bool IsSeen(const EffectEstimate& e) { return std::abs(e.size) > kLimits.min_t * e.std; }

bool IsLowerStrokeByStroke(const ExtendedFit& before, const ExtendedFit& after) {
  for (const Eigen::VectorXd& gain : {WorseInFlow(before, after), Worse(before, after)}) {
    if (gain.size() < 2) continue;
    const double n = static_cast<double>(gain.size());
    const double error = std::sqrt((gain.array() - gain.mean()).square().sum() / (n - 1) / n);
    if (gain.mean() > kLimits.rival_t * error) return true;
  }
  return false;
}

std::vector<std::string> Found(const Explanation& x) {
  std::vector<std::string> ids;
  for (std::size_t k = static_cast<std::size_t>(x.started); k < x.chosen.size(); ++k)
    ids.push_back(x.model->effects[x.chosen[k].effect]->id);
  return ids;
}

}  // namespace

bool MayHoldWrongEffect(const Explanation& x) {
  if (x.started == 0 || !x.base.solved) return false;
  if (x.verdict == Verdict::kUnknown || x.partial) return true;
  return !std::all_of(x.final.effects.begin(), x.final.effects.begin() + x.started, IsSeen);
}

std::optional<EffectSwap> SwapFor(const std::string& id, const Explanation& as_it_is,
                                  const Explanation& without) {
  if (!without.base.solved) return std::nullopt;
  const std::vector<std::string> in = Found(without);
  if (Contains(in, id)) return std::nullopt;
  const double before = as_it_is.base.rms_holdout, after = without.final.rms_holdout;
  const bool explains = without.verdict != Verdict::kUnknown;
  const EffectSwap swap{id, in, before, after, explains, explains && !without.partial};
  const bool as_well = after <= (1 + kSameError) * as_it_is.final.rms_holdout &&
                       without.final.excess_ratio <= as_it_is.final.excess_ratio + kSameError;
  if (in.empty()) return as_well && !as_it_is.base.effects.empty() ? std::optional(swap) : std::nullopt;
  const bool lower = after < before && IsLowerStrokeByStroke(as_it_is.base, without.final);
  if (!lower) return std::nullopt;
  const bool simpler = as_well && without.chosen.size() < as_it_is.chosen.size();
  return simpler || after < as_it_is.final.rms_holdout ? std::optional(swap) : std::nullopt;
}

std::optional<EffectSwap> BestSwap(const ExplainOptions& options, const Explanation& as_it_is,
                                   const std::function<Explanation(const std::string&)>& without) {
  std::optional<EffectSwap> best;
  if (!options.try_swaps || !MayHoldWrongEffect(as_it_is)) return best;
  for (const std::string& id : options.start) {
    auto swap = SwapFor(id, as_it_is, without(id));
    if (swap && (!best || swap->rms_after < best->rms_after)) best = std::move(swap);
  }
  return best;
}

}  // namespace hydroscope
