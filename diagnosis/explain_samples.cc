#include <algorithm>
#include <cmath>

#include "diagnosis/effect_ranking.h"
#include "diagnosis/explain.h"
#include "diagnosis/generic_laws.h"

namespace hydroscope {
namespace {

constexpr int kRounds = 4;
constexpr double kClose = 0.1;  ///< effects that gain this share of the best are refined
constexpr double kFirstLookT =
    3.0;  ///< ExplainOptions::second_t before shapes are refined, which makes sizes surer
constexpr double kSettled = 0.005;  ///< change of the excess ratio

/// An effect to refine, in a model that has the others.
struct Refinement {
  EffectChoice choice;
  std::vector<EffectChoice> others;
};

/// The effects a candidate was added to.
std::vector<EffectChoice> Before(const ExtendedFit& fit) {
  std::vector<EffectChoice> choices;
  for (std::size_t k = 0; k + 1 < fit.effects.size(); ++k) choices.push_back(fit.effects[k].choice);
  return choices;
}

/// Effects that come close to the best and can be refined.
std::vector<Refinement> CloseTo(const Explanation& found, const ExplainOptions& options) {
  std::vector<Refinement> work;
  for (const auto& ranking : {found.ranking, found.second})
    for (const RankedEffect& r : ranking)
      if (r.fit.solved && !found.model->effects[r.effect]->nonlinear.empty() &&
          r.gain > std::max(options.min_gain, kClose * ranking.front().gain))
        work.push_back({r.fit.effects.back().choice, Before(r.fit)});
  return work;
}

/// A law with one parameter keeps none but refined shapes: the grid was for finding it.
void DropGrid(ModelStructure& model) {
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    auto& shapes = model.effect_shapes[e];
    const bool any =
        std::any_of(shapes.begin(), shapes.end(), [](const EffectShape& s) { return s.refined && !s.on; });
    if (any && model.effects[e]->implied)
      std::erase_if(shapes, [](const EffectShape& s) { return !s.refined; });
  }
}

}  // namespace

Explanation ExplainSamples(std::shared_ptr<const ModelStructure> model,
                           std::span<const StrokeStretches> strokes, const WindowSamples& window,
                           const ExplainOptions& options) {
  auto with_laws = std::make_shared<ModelStructure>(*model);
  AddGenericLaws(*with_laws);
  if (!options.start.empty()) {
    const CandidateModel start =
        StartModel(StrokeSet(with_laws, GramsOf(with_laws, strokes, window), window), options.start);
    RefineModel(*with_laws, strokes, window, start.choices);
    DropGrid(*with_laws);
  }
  model = with_laws;
  ExplainOptions first_look = options;
  first_look.second_t = kFirstLookT;
  Explanation out = Explain(StrokeSet(model, GramsOf(model, strokes, window), window), first_look);
  for (int round = 0; round < kRounds; ++round) {
    auto refined = std::make_shared<ModelStructure>(*model);
    const int columns = refined->column_count();
    RefineModel(*refined, strokes, window, out.chosen);
    if (round == 0)
      for (const Refinement& close : CloseTo(out, options))
        RefineOne(*refined, strokes, window, close.others, close.choice);
    const bool strict = round > 0 || out.chosen.size() < 2;
    if (refined->column_count() == columns && strict) return out;
    DropGrid(*refined);
    model = refined;
    const double excess_before = out.final.excess_ratio;
    out = Explain(StrokeSet(model, GramsOf(model, strokes, window), window), options);
    if (out.chosen.empty()) return out;
    const bool all_refined = std::all_of(out.chosen.begin(), out.chosen.end(), [&](const EffectChoice& c) {
      return model->effects[c.effect]->nonlinear.empty() || model->effect_shapes[c.effect][c.shape].refined;
    });
    const bool settled = all_refined && std::abs(excess_before - out.final.excess_ratio) < kSettled;
    if (settled || (all_refined && out.chosen.size() < 2 && out.verdict != Verdict::kUnknown)) return out;
  }
  return out;
}

}  // namespace hydroscope
