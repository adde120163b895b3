#include "diagnosis/effect_ranking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "core/contains.h"
#include "core/distributions.h"
#include "core/quantile.h"
#include "diagnosis/moved_parameter.h"

namespace hydroscope {
namespace {

/// Noise variances over all strokes that two effects which are the same differ by: what refining a shape leaves.
constexpr double kSameOnAllStrokes = 1;

double TwoSidedP(double t, double degrees) {
  if (!(degrees >= 1) || !std::isfinite(t)) return 1.0;
  return StudentTwoSided(t, degrees);
}

Eigen::VectorXd DifferenceWhereBoth(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  std::vector<double> worse;
  if (a.size() != b.size()) return {};  // not of the same strokes
  for (Eigen::Index s = 0; s < a.size(); ++s)
    if (std::isfinite(a[s]) && std::isfinite(b[s])) worse.push_back(a[s] - b[s]);
  return Eigen::Map<const Eigen::VectorXd>(worse.data(), static_cast<Eigen::Index>(worse.size()));
}

bool Uses(const CandidateModel& model, int effect) {
  return std::any_of(model.choices.begin(), model.choices.end(),
                     [&](const auto& c) { return c.effect == effect; });
}

/// A law that is confused with `simpler` and has more free numbers: a leak that grows with the temperature, and a leak.
bool IsFreerThan(const Effect& law, const Effect& simpler) {
  return FreeNumbers(law) > FreeNumbers(simpler) && Contains(law.confused_with, simpler.id);
}

/// Effect::Twin::least that a law asks of a twin.
double LeastOfTwin(const Effect& law, std::string_view twin) {
  for (const Effect::Twin& t : law.twins)
    if (t.id == twin) return t.least;
  return 0;
}

/// Best first; of gains that are the same but for less than a noise variance the library's order decides.
void BestFirst(std::vector<RankedEffect>& ranking) {
  std::stable_sort(ranking.begin(), ranking.end(), [](const RankedEffect& a, const RankedEffect& b) {
    if (a.fit.solved != b.fit.solved) return a.fit.solved;
    if (a.lawful != b.lawful) return a.lawful;
    return std::round(a.gain) > std::round(b.gain);
  });
}

}  // namespace

bool AreConfused(const Effect& a, const Effect& b) {
  const auto says = [](const Effect& one, const Effect& other) {
    return Contains(one.confused_with, other.id);
  };
  return says(a, b) || says(b, a);
}

std::size_t FreeNumbers(const Effect& effect) { return effect.implied ? 0 : effect.nonlinear.size(); }

const NonlinearParameter* NumberAtItsLimit(const ModelStructure& model, const EffectChoice& choice,
                                           double limit_share) {
  const Effect& effect = *model.effects[choice.effect];
  const EffectShape& shape = model.effect_shapes[choice.effect][choice.shape];
  if (!shape.refined || effect.implied || effect.grid.empty()) return nullptr;
  for (std::size_t i = 0; i < shape.nonlinear.size(); ++i) {
    const NonlinearParameter& value = effect.nonlinear[i];
    const double margin = limit_share * (value.max - value.min);
    const bool inside = shape.nonlinear[i] > value.min + margin && shape.nonlinear[i] < value.max - margin;
    if (!inside && value.std <= 0) return &value;
  }
  return nullptr;
}

Eigen::VectorXd Worse(const ExtendedFit& a, const ExtendedFit& b) {
  return DifferenceWhereBoth(a.excess, b.excess);
}

Eigen::VectorXd WorseInFlow(const ExtendedFit& a, const ExtendedFit& b) {
  return DifferenceWhereBoth(a.flow_error, b.flow_error);
}

std::vector<std::string> TwinsOf(const ModelStructure& model, std::string_view id) {
  std::vector<std::string> twins;
  const auto add = [&](const std::string& twin) {
    if (!Contains(twins, twin)) twins.push_back(twin);
  };
  for (const auto* effects : {&model.effects, &model.sample_effects})
    for (const auto& effect : *effects)
      for (const Effect::Twin& twin : effect->twins) {
        if (effect->id == id) add(twin.id);
        if (twin.id == id) add(effect->id);
      }
  return twins;
}

const Effect::Twin* FindTwin(const ModelStructure& model, std::string_view a, std::string_view b) {
  for (const auto* effects : {&model.effects, &model.sample_effects})
    for (const auto& effect : *effects)
      for (const Effect::Twin& twin : effect->twins)
        if ((effect->id == a && twin.id == b) || (effect->id == b && twin.id == a)) return &twin;
  return nullptr;
}

std::vector<std::vector<std::string>> ClassesOf(const Explanation& explanation,
                                                const std::vector<std::string>& group) {
  const auto fit_of = [&](const std::string& id) -> const ExtendedFit* {
    const auto ranked = std::ranges::find(explanation.ranking, id, &RankedEffect::id);
    return ranked != explanation.ranking.end() && ranked->fit.solved ? &ranked->fit : nullptr;
  };
  const auto are_one = [&](const std::string& a, const std::string& b) {
    const ExtendedFit *one = fit_of(a), *other = fit_of(b);
    if (one == nullptr || other == nullptr || FindTwin(*explanation.model, a, b) == nullptr) return false;
    return Worse(*one, *other).cwiseAbs().sum() < kSameOnAllStrokes * explanation.base.noise_variance;
  };
  std::vector<std::vector<std::string>> classes;
  for (const std::string& id : group) {
    const auto own = std::ranges::find_if(classes, [&](const auto& c) { return are_one(c.front(), id); });
    if (own == classes.end())
      classes.push_back({id});
    else
      own->push_back(id);
  }
  return classes;
}

CandidateModel StartModel(const StrokeSet& strokes, const std::vector<std::string>& ids) {
  CandidateModel model;
  const auto& library = strokes.model().effects;
  for (const std::string& id : ids) {
    const auto at = std::find_if(library.begin(), library.end(), [&](const auto& e) { return e->id == id; });
    if (at == library.end()) return {};
    const EffectChoice best = strokes.BestShape(static_cast<int>(at - library.begin()), model.choices);
    if (best.shape < 0) return {};
    model.choices.push_back(best);
  }
  model.fit = strokes.Fit(model.choices);
  return model;
}

Explanation BeginExplanation(const StrokeSet& strokes, const ExplainOptions& options,
                             const CandidateModel& start, const EffectRanking& ranking) {
  Explanation out;
  out.model = strokes.shared_model();
  out.base = out.final = start.fit;
  out.chosen = start.choices;
  out.started = static_cast<int>(start.choices.size());
  out.steps.push_back({"", out.base.rms_holdout, out.base.excess_ratio});
  out.evidence_scale = options.evidence_scale;
  out.measured = options.measured;
  if (out.base.solved) out.ranking = ranking.Rank(start);
  return out;
}

double EffectRanking::Cost(const ExtendedFit& fit) const {
  double cost = 0;
  for (const EffectEstimate& e : fit.effects) {
    const Effect& effect = *strokes_.model().effects[e.choice.effect];
    // A nonlinear parameter that the law ties to the size is no freedom once it is where the law wants it.
    if (!(effect.implied && e.consistent))
      cost += options_.nonlinear_cost * static_cast<double>(effect.nonlinear.size());
  }
  return cost;
}

double EffectRanking::Gain(const ExtendedFit& from, const ExtendedFit& to) const {
  return Worse(from, to).sum() / noise_ - Cost(to) + Cost(from);
}

bool EffectRanking::IsConfirmed(int effect) const {
  const auto known = options_.measured.find(strokes_.model().effects[effect]->id);
  return known != options_.measured.end() &&
         std::abs(known->second.size) > options_.min_t * known->second.std;
}

bool EffectRanking::IsRefuted(const EffectEstimate& e) const {
  const auto known = options_.measured.find(strokes_.model().effects[e.choice.effect]->id);
  return known != options_.measured.end() &&
         std::abs(e.size - known->second.size) > options_.min_t * std::hypot(e.std, known->second.std);
}

bool EffectRanking::IsTwin(const Contender& candidate, const Contender& best) const {
  const auto& effects = strokes_.model().effects;
  const Effect::Twin* const twin =
      FindTwin(strokes_.model(), effects[candidate.effect]->id, effects[best.effect]->id);
  if (twin == nullptr) return false;
  // Columns of rates of smoothed signals bring noise that alternating signs do not see: small gains differ by it, and an
  // effect that leaves less than the noise owes it part of its gain.
  const double excess = candidate.fit->excess_ratio, least = best.fit->excess_ratio;
  const bool as_good = least < -options_.floor_error && excess < options_.floor_error;
  return as_good ||
         (candidate.gain > twin->share * best.gain - options_.sure_gain && excess < least + twin->excess);
}

bool EffectRanking::IsStrong(const EffectEstimate& e) const {
  return e.admissible && std::abs(e.size) > options_.second_t * e.std / strokes_.student();
}

CandidateModel EffectRanking::With(const CandidateModel& on, const EffectChoice& choice) const {
  CandidateModel out{on.choices, {}};
  out.choices.push_back(choice);
  out.fit = strokes_.Fit(out.choices);
  return out;
}

RankedEffect EffectRanking::Try(const CandidateModel& on, int index) const {
  const Effect& effect = *strokes_.model().effects[index];
  RankedEffect ranked;
  ranked.effect = index;
  ranked.id = effect.id;
  if (const auto why = options_.untestable.find(effect.id); why != options_.untestable.end()) {
    ranked.why_not = why->second;
    return ranked;
  }
  bool forbidden = false, separable = false, excited = false;
  for (const int shape : ShapesFor(strokes_.model(), index, on.choices)) {
    if (!strokes_.Measured({index, shape})) continue;
    ExtendedFit fit = With(on, {index, shape}).fit;
    if (!fit.solved) continue;
    separable = true;
    const EffectEstimate& size = fit.effects.back();
    // Testable: a size that matters would stand out of the noise, and of what the model misses from stroke to stroke.
    const double matters = options_.matters_times * effect.typical;
    excited = excited || options_.min_t * size.model_std < matters;
    ranked.testable = ranked.testable || options_.min_t * std::max(size.model_std, size.std) < matters;
    if (std::all_of(fit.effects.begin(), fit.effects.end(), [](const auto& e) { return e.admissible; }))
      TakeIfBetter(on, std::move(fit), shape, ranked);
    else
      forbidden = forbidden || !size.admissible;
  }
  ranked.why_not = WhyNot(ranked, {separable, forbidden, excited});
  return ranked;
}

void EffectRanking::TakeIfBetter(const CandidateModel& on, ExtendedFit fit, int shape,
                                 RankedEffect& ranked) const {
  const double gain = Gain(on.fit, fit);
  const EffectEstimate& size = fit.effects.back();
  const EffectShape& tried = strokes_.model().effect_shapes[ranked.effect][shape];
  const bool lawful = (size.consistent || !tried.refined) && !IsRefuted(size);
  if (ranked.fit.solved && (lawful == ranked.lawful ? gain <= ranked.gain : ranked.lawful)) return;
  const double degrees = strokes_.strokes() - 1.0;
  const double t = size.size / (size.std / strokes_.student());
  ranked.gain = gain;
  ranked.p_value = TwoSidedP(t, degrees);
  ranked.lawful = lawful;
  ranked.stands_out = ranked.lawful && gain > options_.min_gain && std::abs(t) > options_.min_t &&
                      (gain > options_.trifle_gain ||
                       FindMovedParameter(strokes_.model(), on.fit, fit, options_.biased).has_value());
  ranked.significant = ranked.stands_out && fit.rms_holdout < on.fit.rms_holdout;
  ranked.nonlinear = tried.nonlinear;
  ranked.fit = std::move(fit);
}

Told EffectRanking::WhyNot(const RankedEffect& ranked, const Tried& tried) const {
  const bool only_forbidden = tried.forbidden && !ranked.fit.solved;
  if (ranked.testable && ranked.fit.solved) return {};
  if (ranked.testable || (only_forbidden && tried.excited))
    return Tell("it would fit only with a sign or size that physics forbids",
                "er passte nur mit Vorzeichen oder Größe, die die Physik verbietet");
  if (only_forbidden)
    return Tell(
        "it would fit only with a sign or size that physics forbids, and even a large one would hide in the other "
        "parameters",
        "er passte nur mit Vorzeichen oder Größe, die die Physik verbietet, und selbst ein großer verschwände in den "
        "anderen Parametern");
  if (tried.separable && tried.excited)
    return Tell(
        "what the model misses differs so from stroke to stroke that even a large one would hide in it",
        "was dem Modell fehlt, ist von Hub zu Hub so verschieden, dass selbst ein großer darin verschwände");
  if (tried.separable)
    return Tell("these strokes excite it too little: even a large one would hide in the other parameters",
                "diese Hübe regen ihn zu wenig an: selbst ein großer verschwände in den anderen Parametern");
  if (strokes_.model().effect_shapes[ranked.effect].empty())
    return Tell("nothing like it was found in what the model leaves",
                "in dem, was das Modell übrig lässt, fand sich nichts dergleichen");
  if (strokes_.Measured({ranked.effect, 0}))
    return Tell("these strokes cannot tell it from the parameters of the model",
                "diese Hübe trennen ihn nicht von den Parametern des Modells");
  return Tell("the signals it needs have no usable samples in these strokes",
              "die Signale, die er braucht, haben in diesen Hüben keine brauchbaren Werte");
}

std::vector<RankedEffect> EffectRanking::Rank(const CandidateModel& on) const {
  std::vector<RankedEffect> ranking;
  for (int e = 0; e < static_cast<int>(strokes_.model().effects.size()); ++e) {
    const std::string& id = strokes_.model().effects[e]->id;
    const bool excluded = Contains(options_.exclude, id);
    if (!Uses(on, e) && !excluded && !strokes_.model().effects[e]->generic) ranking.push_back(Try(on, e));
  }
  RefuteByTwins(ranking);
  BestFirst(ranking);
  PreferStored(ranking);
  PreferMeasured(ranking);
  return ranking;
}

void EffectRanking::RefuteByTwins(std::vector<RankedEffect>& ranking) const {
  for (RankedEffect& law : ranking)
    for (const RankedEffect& twin : ranking) {
      const double least = LeastOfTwin(*strokes_.model().effects[law.effect], twin.id);
      const double reached = twin.fit.solved ? std::max(twin.gain, 0.0) : 0;
      if (!law.fit.solved || law.gain <= options_.doubt_remainder || !twin.testable ||
          reached >= least * law.gain)
        continue;
      law.fit = {};
      law.gain = 0;
      law.testable = law.stands_out = law.significant = false;
      law.why_not = Tell(
          "what it would explain is noise that it smooths: {} would explain as much of a late signal, and does not",
          "was er erklären würde, ist Rauschen, das er glättet: {} würde bei einem verspäteten Signal ebenso viel "
          "erklären und tut es nicht",
          twin.id);
    }
}

/// Of effects that explain as much, the best that stored strokes can test as well comes first: a name that
/// the history can be asked about.
void EffectRanking::PreferStored(std::vector<RankedEffect>& ranking) const {
  const auto needs_samples = [&](const RankedEffect& r) {
    return strokes_.model().effects[r.effect]->needs_samples;
  };
  if (ranking.empty() || !ranking.front().significant || !needs_samples(ranking.front())) return;
  const auto stored = std::find_if(ranking.begin(), ranking.end(), [&](const RankedEffect& r) {
    return r.significant && !needs_samples(r) && r.gain > ranking.front().gain - options_.rival_gain;
  });
  if (stored != ranking.end()) std::rotate(ranking.begin(), stored, stored + 1);
}

/// Of effects that explain as much, one that was measured elsewhere comes first.
void EffectRanking::PreferMeasured(std::vector<RankedEffect>& ranking) const {
  const auto known = std::find_if(ranking.begin(), ranking.end(), [&](const RankedEffect& r) {
    return r.significant && IsConfirmed(r.effect) &&
           IsRival(r.fit, ranking.front().fit, ranking.front().gain);
  });
  if (known != ranking.end()) std::rotate(ranking.begin(), known, known + 1);
}

std::vector<RankedEffect> EffectRanking::RankGeneric(const CandidateModel& on) const {
  std::vector<RankedEffect> ranking;
  for (int e = 0; e < static_cast<int>(strokes_.model().effects.size()); ++e)
    if (strokes_.model().effects[e]->generic) ranking.push_back(Try(on, e));
  BestFirst(ranking);
  return ranking;
}

double EffectRanking::DesignEffect(const CandidateModel& on) const {
  const double student = strokes_.student();
  std::vector<double> effects;
  for (const auto& ranking : {Rank(on), RankGeneric(on)})
    for (const RankedEffect& law : ranking) {
      if (!law.fit.solved) continue;
      const EffectEstimate& size = law.fit.effects.back();
      if (size.model_std > 0) effects.push_back(std::pow(size.std / student / size.model_std, 2));
    }
  return std::max(1.0, Median(effects, 1.0));
}

bool EffectRanking::IsRival(const ExtendedFit& candidate, const ExtendedFit& best, double gain) const {
  if (Gain(candidate, best) < options_.rival_gain) return true;
  const Eigen::VectorXd worse = Worse(candidate, best) / noise_;
  const double n = static_cast<double>(worse.size());
  const double mean = worse.mean();
  const double deviation = std::sqrt((worse.array() - mean).square().sum() / (n - 1) / n);
  return mean < options_.rival_t * deviation &&
         worse.sum() < std::max(options_.sure_gain, options_.MayRemain(gain));
}

bool EffectRanking::StaysBeside(const Contender& candidate, const Contender& best, double gain) const {
  const auto& effects = strokes_.model().effects;
  // What a simpler law leaves to a freer one must be more than any complete explanation leaves to a further law.
  const bool simpler = IsFreerThan(*effects[best.effect], *effects[candidate.effect]) &&
                       best.gain - candidate.gain < options_.MayRemain(candidate.gain);
  return simpler || IsTwin(candidate, best) || IsRival(*candidate.fit, *best.fit, gain);
}

bool EffectRanking::StaysWithinItsLimits(const CandidateModel& on, const RankedEffect& candidate,
                                         const RankedEffect& best, double gain) const {
  const auto stays = [&](const ExtendedFit& fit, double gained) {
    return StaysBeside({candidate.effect, &fit, gained}, {best.effect, &best.fit, best.gain}, gain);
  };
  const auto at_limit = [&](const RankedEffect& r, int shape) {
    return NumberAtItsLimit(strokes_.model(), {r.effect, shape}, options_.limit_share) != nullptr;
  };
  const int shape = candidate.fit.effects.back().choice.shape;
  if (!at_limit(candidate, shape) || at_limit(best, best.fit.effects.back().choice.shape))
    return stays(candidate.fit, candidate.gain);
  const std::vector<int> shapes = ShapesFor(strokes_.model(), candidate.effect, on.choices);
  return std::any_of(shapes.begin(), shapes.end(), [&](int other) {
    if (at_limit(candidate, other)) return false;
    const ExtendedFit fit = With(on, {candidate.effect, other}).fit;
    return fit.solved && fit.effects.back().admissible && stays(fit, Gain(on.fit, fit));
  });
}

std::vector<std::string> EffectRanking::SteadyBesideAnother(const CandidateModel& model,
                                                            std::size_t at) const {
  const ModelStructure& structure = strokes_.model();
  const auto goes_with_the_oil = [&](const Effect& e) {
    return e.least_span && e.least_span->channel == structure.temperature_channel;
  };
  const Effect& own = *structure.effects[model.choices[at].effect];
  std::vector<std::string> steady_ids;
  if (!goes_with_the_oil(own)) return steady_ids;
  CandidateModel others{model.choices, {}};
  others.choices.erase(others.choices.begin() + static_cast<std::ptrdiff_t>(at));
  others.fit = strokes_.Fit(others.choices);
  for (int e = 0; others.fit.solved && e < static_cast<int>(structure.effects.size()); ++e) {
    if (!IsFreerThan(own, *structure.effects[e]) || Uses(model, e)) continue;
    const RankedEffect steady = Try(others, e);
    if (!steady.fit.solved || !steady.lawful) continue;
    const std::vector<RankedEffect> beside = Rank(With(others, steady.fit.effects.back().choice));
    if (std::ranges::any_of(beside, [&](const RankedEffect& r) {
          const Effect& law = *structure.effects[r.effect];
          return r.fit.solved && r.lawful && goes_with_the_oil(law) && FreeNumbers(law) == 0 &&
                 IsStrong(r.fit.effects.back()) && IsRival(r.fit, model.fit, 0);
        }))
      steady_ids.push_back(steady.id);
  }
  return steady_ids;
}

bool EffectRanking::IsWeakTwin(const RankedEffect& candidate, const RankedEffect& best, double gain) const {
  return candidate.fit.solved && candidate.lawful && candidate.testable &&
         FindTwin(strokes_.model(), candidate.id, best.id) != nullptr &&
         IsRival(candidate.fit, best.fit, gain);
}

std::vector<std::string> EffectRanking::Rivals(const CandidateModel& on,
                                               const std::vector<RankedEffect>& ranking,
                                               bool complete) const {
  std::vector<std::string> set;
  const RankedEffect& best = ranking.front();
  if (IsConfirmed(best.effect)) return {best.id};
  const double gain = complete ? 0 : best.gain;
  for (const RankedEffect& candidate : ranking)
    if (candidate.id == best.id || (candidate.stands_out ? StaysWithinItsLimits(on, candidate, best, gain)
                                                         : IsWeakTwin(candidate, best, gain)))
      set.push_back(candidate.id);
  return set;
}

std::vector<std::string> EffectRanking::RivalsInDoubt(const std::vector<RankedEffect>& ranking,
                                                      const std::vector<std::string>& set) const {
  const RankedEffect& best = ranking.front();
  if (set.front() != best.id || IsConfirmed(best.effect)) return set;
  std::vector<std::string> all;
  for (const RankedEffect& other : ranking) {
    const bool close =
        options_.IsDownToNoise(other.fit) && other.gain > best.gain - options_.MayRemain(best.gain);
    if (Contains(set, other.id) || (other.stands_out && other.lawful && close)) all.push_back(other.id);
  }
  return all;
}

}  // namespace hydroscope
