#include "diagnosis/nameless_rival.h"

#include <algorithm>
#include <limits>

#include "core/contains.h"

namespace hydroscope {
namespace {

/// Share of a law's own part of the error below which it is much the same as a named effect beside it.
double LeastOwnShare(const Effect& law, const ExplainOptions& options) {
  return law.plain_flow ? options.same_flow : options.same_law;
}

/// Little of the law, on top of `on`, is left beside an effect that may be the one.
bool IsSame(const RankedEffect& law, const CandidateModel& on, const std::vector<EffectChoice>& named,
            double least_share, const EffectRanking& ranking) {
  const EffectEstimate& alone = law.fit.effects.back();
  return std::any_of(named.begin(), named.end(), [&](const EffectChoice& choice) {
    const ExtendedFit both = ranking.With(ranking.With(on, choice), alone.choice).fit;
    return !both.solved || both.effects.back().independent < least_share * alone.independent;
  });
}

}  // namespace

void FindMargin(const StrokeSet& strokes, const ExplainOptions& options, const CandidateModel& start,
                const EffectRanking& ranking, Explanation& out) {
  out.margin = std::numeric_limits<double>::infinity();
  // The best law on top of `on` that is not much the same as one of `named`, if it comes closer than those before.
  const auto look_for_rival = [&](const CandidateModel& on, const std::vector<EffectChoice>& named) {
    for (const RankedEffect& law : ranking.RankGeneric(on)) {
      if (!law.fit.solved) return;
      const double least_share = LeastOwnShare(*strokes.model().effects[law.effect], options);
      if (IsSame(law, on, named, least_share, ranking)) continue;
      const double margin = ranking.Gain(law.fit, out.final);
      if (margin >= out.margin) return;
      out.margin = margin;
      out.margin_law = law.id;
      return;
    }
  };
  const auto started = static_cast<std::size_t>(out.started);
  const bool single = out.chosen.size() == started + 1;
  if (!single) look_for_rival(start, {});
  for (std::size_t k = started; k < out.chosen.size(); ++k) {
    CandidateModel others{out.chosen, {}};
    others.choices.erase(others.choices.begin() + static_cast<std::ptrdiff_t>(k));
    others.fit = strokes.Fit(others.choices);
    std::vector<EffectChoice> named = {out.chosen[k]};
    if (single)
      for (const RankedEffect& r : out.ranking)
        if (r.fit.solved && Contains(out.groups.front(), r.id)) named.push_back(r.fit.effects.back().choice);
    if (others.fit.solved) look_for_rival(others, named);
  }
}

}  // namespace hydroscope
