#include <algorithm>
#include <cmath>

#include "diagnosis/explain.h"
#include "diagnosis/generic_laws.h"

namespace hydroscope {
namespace {

constexpr int kRounds = 4;
constexpr double kClose = 0.1;      ///< effects that gain this share of the best are refined
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

void AddClose(const std::vector<RankedEffect>& ranking, double min_gain, std::vector<Refinement>& work) {
  for (const RankedEffect& r : ranking)
    if (r.fit.solved && r.gain > std::max(min_gain, kClose * ranking.front().gain))
      work.push_back({r.fit.effects.back().choice, Before(r.fit)});
}

/// The effects in the model, each given the others; in the first round also those that come close to the
/// best.
std::vector<Refinement> WorkOf(const Explanation& found, int round, const ExplainOptions& options) {
  std::vector<Refinement> work;
  for (const EffectChoice& chosen : found.chosen) {
    // Laws tied to their size are refined together.
    if (found.chosen.size() > 1 && found.model->effects[chosen.effect]->implied) continue;
    std::vector<EffectChoice> others = found.chosen;
    std::erase(others, chosen);
    work.push_back({chosen, others});
  }
  if (round > 0) return work;
  AddClose(found.ranking, options.min_gain, work);
  AddClose(found.second, options.min_gain, work);
  return work;
}

/// The model with the refined shapes. A law with one parameter keeps none but refined ones: the grid was for
/// finding it.
std::shared_ptr<const ModelStructure> Refined(const ModelStructure& model,
                                              const std::vector<Refinement>& work,
                                              std::span<const EffectChoice> chosen,
                                              std::span<const StrokeStretches> strokes,
                                              const WindowSamples& window, bool& changed) {
  auto refined = std::make_shared<ModelStructure>(model);
  changed = false;
  for (const Refinement& item : work) {
    const Effect& effect = *model.effects[item.choice.effect];
    if (effect.nonlinear.empty()) continue;
    const EffectShape& shape = model.effect_shapes[item.choice.effect][item.choice.shape];
    const std::vector<double> values = RefineNonlinear(model, strokes, window, item.others, item.choice);
    if (values == shape.nonlinear && shape.refined) continue;
    AddShape(*refined, item.choice.effect, values);
    refined->effect_shapes[item.choice.effect].back().refined = true;
    changed = true;
  }
  if (chosen.size() > 1) {
    const auto together = RefineTogether(model, strokes, window, chosen);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const EffectShape& shape = model.effect_shapes[chosen[k].effect][chosen[k].shape];
      if (!model.effects[chosen[k].effect]->implied || (together[k] == shape.nonlinear && shape.refined))
        continue;
      AddShape(*refined, chosen[k].effect, together[k]);
      refined->effect_shapes[chosen[k].effect].back().refined = true;
      changed = true;
    }
  }
  for (std::size_t e = 0; e < refined->effects.size(); ++e) {
    auto& shapes = refined->effect_shapes[e];
    const bool any =
        std::any_of(shapes.begin(), shapes.end(), [](const EffectShape& s) { return s.refined; });
    if (any && refined->effects[e]->implied)
      std::erase_if(shapes, [](const EffectShape& s) { return !s.refined; });
  }
  return refined;
}

}  // namespace

Explanation ExplainSamples(std::shared_ptr<const ModelStructure> model,
                           std::span<const StrokeStretches> strokes, const WindowSamples& window,
                           const ExplainOptions& options) {
  auto with_laws = std::make_shared<ModelStructure>(*model);
  AddGenericLaws(*with_laws);
  model = with_laws;
  Explanation out = Explain(StrokeSet(model, GramsOf(model, strokes, window), window), options);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Refinement> work = WorkOf(out, round, options);
    bool changed = false;
    model = Refined(*model, work, out.chosen, strokes, window, changed);
    if (!changed) return out;
    const std::vector<std::string> set_before = out.set;
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
