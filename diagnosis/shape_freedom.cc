#include "diagnosis/shape_freedom.h"

#include <algorithm>
#include <cmath>

#include "core/contains.h"
#include "diagnosis/effect_ranking.h"

namespace hydroscope {
namespace {

/// The model with `choices`, each at every shape of its grid that the strokes can tell from the others.
CandidateModel AtAllShapes(const StrokeSet& strokes, const std::vector<EffectChoice>& choices) {
  CandidateModel model{choices, strokes.Fit(choices)};
  for (const EffectChoice& choice : choices) {
    const auto grid = static_cast<int>(strokes.model().effects[choice.effect]->grid.size());
    for (int shape = 0; shape < grid; ++shape) {
      if (Contains(model.choices, EffectChoice{choice.effect, shape})) continue;
      std::vector<EffectChoice> more = model.choices;
      more.push_back({choice.effect, shape});
      ExtendedFit fit = strokes.Fit(more);
      if (fit.solved) model = {std::move(more), std::move(fit)};
    }
  }
  return model;
}

/// Whether an effect that was found, other than `k`, is fitted at a shape that its own size contradicts: what
/// such a fit leaves is its own.
bool BesideContradiction(const ModelStructure& model, const Explanation& x, std::size_t k) {
  for (auto j = static_cast<std::size_t>(x.started); j < x.final.effects.size(); ++j) {
    const EffectEstimate& e = x.final.effects[j];
    if (j != k && model.effects[e.choice.effect]->implied && !e.consistent) return true;
  }
  return false;
}

/// Whether effect `k` of the explanation stands out when all others may be any mixture of their shapes.
bool StandsBesideMixtures(const StrokeSet& strokes, const EffectRanking& ranking,
                          const ExplainOptions& options, const Explanation& x,
                          const std::vector<EffectChoice>& others, std::size_t k) {
  const CandidateModel free = AtAllShapes(strokes, others);
  if (free.choices.size() == others.size()) return true;  // nothing is known at several values
  const CandidateModel with = ranking.With(free, x.chosen[k]);
  return with.fit.solved && ranking.Gain(free.fit, with.fit) > options.min_gain &&
         ranking.IsStrong(with.fit.effects.back());
}

}  // namespace

std::vector<std::string> EffectsOfShapes(const StrokeSet& strokes, const Explanation& explanation,
                                         const ExplainOptions& options) {
  struct Resting {
    std::string id;
    double gain;
  };
  const EffectRanking ranking(strokes, options, explanation.base.noise_variance);
  std::vector<Resting> resting;
  const std::vector<EffectChoice>& chosen = explanation.chosen;
  if (explanation.set.empty() || chosen.size() < 2) return {};
  for (auto k = static_cast<std::size_t>(explanation.started); k < chosen.size(); ++k) {
    std::vector<EffectChoice> others = chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (!BesideContradiction(strokes.model(), explanation, k) &&
        StandsBesideMixtures(strokes, ranking, options, explanation, others, k))
      continue;
    const ExtendedFit without = strokes.Fit(others);
    resting.push_back(
        {strokes.model().effects[chosen[k].effect]->id, ranking.Gain(without, explanation.final)});
  }
  const std::size_t found = chosen.size() - static_cast<std::size_t>(explanation.started);
  if (resting.size() == found && found > 1)  // they rest on one another
    resting.erase(std::max_element(resting.begin(), resting.end(),
                                   [](const Resting& a, const Resting& b) { return a.gain < b.gain; }));
  std::vector<std::string> ids;
  for (const Resting& r : resting) ids.push_back(r.id);
  return ids;
}

}  // namespace hydroscope
