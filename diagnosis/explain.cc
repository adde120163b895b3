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
  bool AtFloor(const ExtendedFit& fit, const ExtendedFit& base) const;
  bool IsRival(const ExtendedFit& candidate, const ExtendedFit& best) const;
  std::vector<std::string> Rivals(const std::vector<RankedEffect>& ranking) const;
  std::optional<std::pair<Model, std::vector<std::vector<std::string>>>> SearchPairs(const std::vector<RankedEffect>& ranking) const;
  double Gain(const ExtendedFit& from, const ExtendedFit& to) const {
    return (from.excess.sum() - to.excess.sum()) / noise_;
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
  ranked.why_not = "its signature was not excited in these strokes";
  for (int shape = 0; shape < static_cast<int>(effect.shapes.size()); ++shape) {
    std::vector<EffectChoice> choices = on.choices;
    choices.push_back({index, shape});
    if (!strokes_.Measured(choices.back())) continue;
    ExtendedFit fit = strokes_.Fit(choices);
    if (!fit.solved || fit.effects.back().independent < options_.min_independent) {
      if (!ranked.testable) ranked.why_not = "these strokes cannot tell it from the parameters of the model";
      continue;
    }
    ranked.testable = true;
    const bool admissible = std::all_of(fit.effects.begin(), fit.effects.end(), [](const auto& e) { return e.admissible; });
    const double gain = Gain(on.fit, fit);
    if (ranked.fit.solved && (!admissible || gain <= ranked.gain)) continue;
    if (!admissible) continue;
    const EffectEstimate& size = fit.effects.back();
    const double student = StudentFactor(strokes_.strokes() - 1.0);
    const double t = size.size / (size.std / student);
    ranked.gain = gain;
    ranked.p_value = TwoSidedP(t, strokes_.strokes() - 1.0);
    ranked.significant = gain > options_.min_gain && std::abs(t) > options_.min_t;
    ranked.fit = std::move(fit);
  }
  if (ranked.testable) ranked.why_not = ranked.fit.solved ? "" : "the data ask for a size physics forbids";
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
  return fit.excess_ratio <= std::max(options_.floor_excess, (1 - options_.removed_share) * base.excess_ratio);
}

bool Explainer::IsRival(const ExtendedFit& candidate, const ExtendedFit& best) const {
  const Eigen::VectorXd worse = (candidate.excess - best.excess) / noise_;
  if (worse.sum() < options_.rival_gain) return true;
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
    const std::vector<RankedEffect>& ranking) const {
  struct Pair {
    Model model;
    double gain;
    bool significant;
  };
  std::vector<Pair> pairs;
  const double student = StudentFactor(strokes_.strokes() - 1.0);
  for (std::size_t a = 0; a < ranking.size(); ++a)
    for (std::size_t b = a + 1; b < ranking.size(); ++b) {
      if (!ranking[a].fit.solved || !ranking[b].fit.solved) continue;
      Pair pair;
      pair.model.choices = {ranking[a].fit.effects[0].choice, ranking[b].fit.effects[0].choice};
      pair.model.fit = strokes_.Fit(pair.model.choices);
      if (!pair.model.fit.solved) continue;
      pair.significant = true;
      for (const EffectEstimate& e : pair.model.fit.effects)
        pair.significant = pair.significant && e.admissible && e.independent > options_.min_independent &&
                           std::abs(e.size) > options_.min_t * e.std / student;
      pair.gain = Gain(ranking.front().fit, pair.model.fit);
      if (pair.significant && pair.gain > options_.min_gain) pairs.push_back(std::move(pair));
    }
  if (pairs.empty()) return std::nullopt;
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.gain > b.gain; });
  const Model& best = pairs.front().model;
  const auto id = [&](const EffectChoice& c) { return strokes_.model().effects[c.effect]->id; };
  std::vector<std::vector<std::string>> groups = {{id(best.choices[0])}, {id(best.choices[1])}};
  // A rival pair that shares one effect offers its other effect as an alternative to the best pair's other one.
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    if (!IsRival(pairs[k].model.fit, best.fit)) continue;
    for (int mine = 0; mine < 2; ++mine)
      for (int theirs = 0; theirs < 2; ++theirs)
        if (pairs[k].model.choices[1 - theirs].effect == best.choices[1 - mine].effect)
          groups[mine].push_back(id(pairs[k].model.choices[theirs]));
  }
  return std::make_pair(best, groups);
}

Explanation Explainer::Run() {
  Explanation out;
  Model model;
  model.fit = out.base = out.final = strokes_.Fit({});
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
  model.choices = {best.fit.effects[0].choice};
  model.fit = best.fit;
  out.groups = {Rivals(out.ranking)};
  if (!AtFloor(model.fit, out.base)) {
    if (auto pair = SearchPairs(out.ranking)) {
      model = pair->first;
      out.groups = pair->second;
    }
  } else if (options_.max_effects > 1) {
    const std::vector<RankedEffect> second = Rank(model);
    if (!second.empty() && second.front().significant && second.front().gain > 0.01 * best.gain) {
      model.choices.push_back(second.front().fit.effects.back().choice);
      model.fit = second.front().fit;
      out.groups.push_back(Rivals(second));
    }
  }
  for (std::size_t k = 0; k < model.choices.size(); ++k) {
    const ExtendedFit partial = strokes_.Fit(std::span(model.choices).first(k + 1));
    out.steps.push_back({strokes_.model().effects[model.choices[k].effect]->id, partial.rms_holdout, partial.excess_ratio});
  }
  out.final = model.fit;
  if (!AtFloor(model.fit, out.base)) {
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

}  // namespace hydroscope
