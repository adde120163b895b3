#include "diagnosis/explain.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <optional>

namespace hydroscope {
namespace {

/// Noise energy per equation is the unit of gains: excess energies are divided by it.
double NoiseVariance(const ExtendedFit& fit, double equations) {
  return fit.excess_ratio != 0 ? fit.excess.sum() / fit.excess_ratio / equations : 1.0;
}

double TwoSidedP(double t, double degrees) {
  if (!(degrees >= 1) || !std::isfinite(t)) return 1.0;
  return 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(degrees), std::abs(t)));
}

/// An effect this many times its typical size must stand out, else these strokes cannot test it.
constexpr double kMattersTimes = 5.0;

/// A model under construction: effects chosen so far and their fit.
struct Model {
  std::vector<EffectChoice> choices;
  ExtendedFit fit;
};

class Explainer {
 public:
  Explainer(const StrokeSet& strokes, const ExplainOptions& options) : strokes_(strokes), options_(options) {}

  Explanation Run();

 private:
  std::vector<RankedEffect> Rank(const Model& on) const;
  RankedEffect Try(const Model& on, int effect) const;
  /// The model as it is: base balance and the effects it has already, each in its best shape.
  Model Start() const;
  bool AtFloor(const ExtendedFit& fit, const ExtendedFit& base) const;
  /// Strong enough to stand as the second of two effects.
  bool IsStrong(const EffectEstimate& e) const {
    return e.admissible && std::abs(e.size) > options_.second_t * e.std / StudentFactor(strokes_.strokes() - 1.0);
  }
  bool IsRival(const ExtendedFit& candidate, const ExtendedFit& best) const;
  std::vector<std::string> Rivals(const std::vector<RankedEffect>& ranking) const;
  std::optional<std::pair<Model, std::vector<std::vector<std::string>>>> SearchPairs(
      const Model& on, const std::vector<RankedEffect>& ranking) const;
  /// Held-out error energy removed, in noise variances, less the price of nonlinear parameters.
  double Gain(const ExtendedFit& from, const ExtendedFit& to) const {
    return (from.excess.sum() - to.excess.sum()) / noise_ - Cost(to) + Cost(from);
  }
  double Cost(const ExtendedFit& fit) const {
    std::size_t nonlinear = 0;
    for (const EffectEstimate& e : fit.effects)
      nonlinear += strokes_.model().effects[e.choice.effect]->nonlinear.size();
    return options_.nonlinear_cost * static_cast<double>(nonlinear);
  }

  const StrokeSet& strokes_;
  const ExplainOptions& options_;
  double noise_ = 1.0;
};

RankedEffect Explainer::Try(const Model& on, int index) const {
  const Effect& effect = *strokes_.model().effects[index];
  RankedEffect ranked;
  ranked.effect = index;
  ranked.id = effect.id;
  ranked.why_not = "its signals did not move in these strokes";
  const double degrees = strokes_.strokes() - 1.0;
  for (int shape = 0; shape < static_cast<int>(strokes_.model().effect_shapes[index].size()); ++shape) {
    std::vector<EffectChoice> choices = on.choices;
    choices.push_back({index, shape});
    if (!strokes_.Measured(choices.back())) continue;
    ExtendedFit fit = strokes_.Fit(choices);
    if (!fit.solved) {
      ranked.why_not = "these strokes cannot tell it from the parameters of the model";
      continue;
    }
    const EffectEstimate& size = fit.effects.back();
    // Testable: a size that matters would stand out of the noise.
    ranked.testable = ranked.testable || options_.min_t * std::max(size.model_std, size.std) < kMattersTimes * effect.typical;
    if (!std::all_of(fit.effects.begin(), fit.effects.end(), [](const auto& e) { return e.admissible; })) continue;
    const double gain = Gain(on.fit, fit);
    if (ranked.fit.solved && gain <= ranked.gain) continue;
    const double t = size.size / (size.std / StudentFactor(degrees));
    ranked.gain = gain;
    ranked.p_value = TwoSidedP(t, degrees);
    ranked.significant = gain > options_.min_gain && std::abs(t) > options_.min_t;
    ranked.nonlinear = strokes_.model().effect_shapes[index][shape].nonlinear;
    ranked.fit = std::move(fit);
  }
  if (ranked.testable)
    ranked.why_not = ranked.fit.solved ? "" : "the data ask for a size physics forbids";
  else if (ranked.fit.solved)
    ranked.why_not = "these strokes excite it too little: even a large one would hide in the other parameters";
  return ranked;
}

std::vector<RankedEffect> Explainer::Rank(const Model& on) const {
  std::vector<RankedEffect> ranking;
  for (int e = 0; e < static_cast<int>(strokes_.model().effects.size()); ++e) {
    const bool used = std::any_of(on.choices.begin(), on.choices.end(), [&](const auto& c) { return c.effect == e; });
    const std::string& id = strokes_.model().effects[e]->id;
    const bool excluded = std::find(options_.exclude.begin(), options_.exclude.end(), id) != options_.exclude.end();
    if (!used && !excluded) ranking.push_back(Try(on, e));
  }
  std::stable_sort(ranking.begin(), ranking.end(), [](const RankedEffect& a, const RankedEffect& b) {
    if (a.fit.solved != b.fit.solved) return a.fit.solved;
    return a.gain > b.gain;
  });
  return ranking;
}

bool Explainer::AtFloor(const ExtendedFit& fit, const ExtendedFit& base) const {
  return fit.excess_ratio <= options_.floor_excess + options_.left_share * std::max(0.0, base.excess_ratio);
}

bool Explainer::IsRival(const ExtendedFit& candidate, const ExtendedFit& best) const {
  if (Gain(candidate, best) < options_.rival_gain) return true;
  const Eigen::VectorXd worse = (candidate.excess - best.excess) / noise_;
  const double n = static_cast<double>(worse.size());
  const double mean = worse.mean();
  const double deviation = std::sqrt((worse.array() - mean).square().sum() / (n - 1) / n);
  return mean < options_.rival_t * deviation && worse.sum() < 10 * options_.rival_gain;
}

std::vector<std::string> Explainer::Rivals(const std::vector<RankedEffect>& ranking) const {
  std::vector<std::string> set;
  for (const RankedEffect& candidate : ranking)
    if (candidate.significant && IsRival(candidate.fit, ranking.front().fit)) set.push_back(candidate.id);
  return set;
}

std::optional<std::pair<Model, std::vector<std::vector<std::string>>>> Explainer::SearchPairs(
    const Model& on, const std::vector<RankedEffect>& ranking) const {
  const std::size_t first = on.choices.size();
  struct Pair {
    Model model;
    double gain;
    bool significant;
  };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < ranking.size(); ++a)
    for (std::size_t b = a + 1; b < ranking.size(); ++b) {
      if (!ranking[a].fit.solved || !ranking[b].fit.solved) continue;
      Pair pair;
      pair.model.choices = on.choices;
      pair.model.choices.push_back(ranking[a].fit.effects.back().choice);
      pair.model.choices.push_back(ranking[b].fit.effects.back().choice);
      pair.model.fit = strokes_.Fit(pair.model.choices);
      if (!pair.model.fit.solved) continue;
      pair.significant = std::all_of(pair.model.fit.effects.begin() + static_cast<std::ptrdiff_t>(first),
                                     pair.model.fit.effects.end(),
                                     [&](const EffectEstimate& e) { return IsStrong(e); });
      pair.gain = Gain(ranking.front().fit, pair.model.fit);
      if (pair.significant && pair.gain > options_.min_gain) pairs.push_back(std::move(pair));
    }
  if (pairs.empty()) return std::nullopt;
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.gain > b.gain; });
  const Model& best = pairs.front().model;
  const auto id = [&](const EffectChoice& c) { return strokes_.model().effects[c.effect]->id; };
  std::vector<std::vector<std::string>> groups = {{id(best.choices[first])}, {id(best.choices[first + 1])}};
  // A rival pair that shares one effect offers its other effect as an alternative to the best pair's other one.
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    if (!IsRival(pairs[k].model.fit, best.fit)) continue;
    for (int mine = 0; mine < 2; ++mine)
      for (int theirs = 0; theirs < 2; ++theirs)
        if (pairs[k].model.choices[first + 1 - theirs].effect == best.choices[first + 1 - mine].effect)
          groups[mine].push_back(id(pairs[k].model.choices[first + theirs]));
  }
  return std::make_pair(best, groups);
}

Model Explainer::Start() const {
  Model model;
  const auto& library = strokes_.model().effects;
  for (const std::string& id : options_.start) {
    const auto at = std::find_if(library.begin(), library.end(), [&](const auto& e) { return e->id == id; });
    const EffectChoice best = at == library.end() ? EffectChoice{0, -1}
                                                  : strokes_.BestShape(static_cast<int>(at - library.begin()), model.choices);
    if (best.shape < 0) return {};  // its fit is not solved
    model.choices.push_back(best);
  }
  model.fit = strokes_.Fit(model.choices);
  return model;
}

Explanation Explainer::Run() {
  Explanation out;
  out.model = strokes_.shared_model();
  Model model = Start();
  out.base = out.final = model.fit;
  out.chosen = model.choices;
  out.started = static_cast<int>(model.choices.size());
  out.steps.push_back({"", out.base.rms_holdout, out.base.excess_ratio});
  if (!out.base.solved) return out;
  noise_ = NoiseVariance(out.base, strokes_.equations());
  out.ranking = Rank(model);
  const bool any = !out.ranking.empty() && out.ranking.front().significant;
  if (!any) {
    out.verdict = out.base.excess_ratio <= options_.floor_excess ? Verdict::kAdequate : Verdict::kUnknown;
    return out;
  }
  const RankedEffect& best = out.ranking.front();
  const Model start = model;
  model.choices.push_back(best.fit.effects.back().choice);
  model.fit = best.fit;
  out.groups = {Rivals(out.ranking)};
  bool complete = true;
  if (!AtFloor(model.fit, out.base)) {
    if (auto pair = SearchPairs(start, out.ranking)) {
      model = pair->first;
      out.groups = pair->second;
    }
  } else {
    out.second = Rank(model);
    const std::vector<RankedEffect>& second = out.second;
    const bool remainder = !second.empty() && second.front().significant;
    if (remainder && options_.max_effects > 1 && IsStrong(second.front().fit.effects.back())) {
      model.choices.push_back(second.front().fit.effects.back().choice);
      model.fit = second.front().fit;
      out.groups.push_back(Rivals(second));
    } else if (!second.empty() && second.front().gain > options_.max_remainder) {
      complete = false;  // the right law leaves no scraps for another effect to pick up
    }
  }
  for (std::size_t k = start.choices.size(); k < model.choices.size(); ++k) {
    const ExtendedFit partial = strokes_.Fit(std::span(model.choices).first(k + 1));
    out.steps.push_back({strokes_.model().effects[model.choices[k].effect]->id, partial.rms_holdout, partial.excess_ratio});
  }
  out.final = model.fit;
  out.chosen = model.choices;
  if (!AtFloor(model.fit, out.base) || !complete) {
    out.verdict = Verdict::kUnknown;
    out.partial = true;
    out.groups.clear();
    return out;
  }
  bool ambiguous = false;
  for (const auto& group : out.groups) {
    out.set.push_back(group.front());
    ambiguous = ambiguous || group.size() > 1;
  }
  for (const auto& group : out.groups)
    for (std::size_t k = 1; k < group.size(); ++k)
      if (std::find(out.set.begin(), out.set.end(), group[k]) == out.set.end()) out.set.push_back(group[k]);
  out.verdict = ambiguous ? Verdict::kAmbiguous : Verdict::kNamed;
  return out;
}

}  // namespace

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAdequate: return "adequate";
    case Verdict::kNamed: return "named";
    case Verdict::kAmbiguous: return "ambiguous";
    case Verdict::kUnknown: return "unknown";
  }
  return "unknown";
}

Explanation Explain(const StrokeSet& strokes, const ExplainOptions& options) { return Explainer(strokes, options).Run(); }

namespace {

/// The effects a candidate was added to.
std::vector<EffectChoice> Before(const ExtendedFit& fit) {
  std::vector<EffectChoice> choices;
  for (std::size_t k = 0; k + 1 < fit.effects.size(); ++k) choices.push_back(fit.effects[k].choice);
  return choices;
}

}  // namespace

Explanation ExplainSamples(std::shared_ptr<const ModelStructure> model, std::span<const StrokeStretches> strokes,
                           const WindowSamples& window, const ExplainOptions& options) {
  constexpr int kRounds = 3;
  constexpr double kClose = 0.1;  // refine effects that gain this share of the best
  Explanation out = Explain(StrokeSet(model, GramsOf(model, strokes, window), window), options);
  for (int round = 0; round < kRounds; ++round) {
    // The effects in the model, each given the others; then those that come close to the best as the only one.
    std::vector<std::pair<EffectChoice, std::vector<EffectChoice>>> work;
    for (const EffectChoice& chosen : out.chosen) {
      std::vector<EffectChoice> others = out.chosen;
      std::erase(others, chosen);
      work.emplace_back(chosen, others);
    }
    if (round == 0) {
      for (const RankedEffect& r : out.ranking)
        if (r.fit.solved && r.gain > std::max(options.min_gain, kClose * out.ranking.front().gain))
          work.emplace_back(r.fit.effects.back().choice, Before(r.fit));
      for (const RankedEffect& r : out.second)
        if (r.fit.solved && r.gain > std::max(options.min_gain, kClose * out.second.front().gain))
          work.emplace_back(r.fit.effects.back().choice, Before(r.fit));
    }
    auto refined = std::make_shared<ModelStructure>(*model);
    bool changed = false;
    for (const auto& [choice, others] : work) {
      if (model->effects[choice.effect]->nonlinear.empty()) continue;
      const std::vector<double> values = RefineNonlinear(*model, strokes, window, others, choice);
      if (values == model->effect_shapes[choice.effect][choice.shape].nonlinear) continue;
      AddShape(*refined, choice.effect, values);
      changed = true;
    }
    if (!changed) return out;
    const std::size_t effects_before = out.chosen.size();
    const double excess_before = out.final.excess_ratio;
    model = refined;
    out = Explain(StrokeSet(model, GramsOf(model, strokes, window), window), options);
    const bool settled = out.chosen.size() == effects_before && excess_before - out.final.excess_ratio < 0.005;
    if (settled || out.chosen.size() < 2) {
      if (round > 0 || out.verdict != Verdict::kUnknown) return out;
    }
  }
  return out;
}

}  // namespace hydroscope
