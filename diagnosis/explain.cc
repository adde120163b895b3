#include "diagnosis/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnosis/effect_ranking.h"
#include "diagnosis/explain_own_machine.h"

namespace hydroscope {
namespace {

using Groups = std::vector<std::vector<std::string>>;

/// p-value below which a law beside nothing else is no chance: of a hundred that are tried one in ten thousand logs (Bonferroni).
constexpr double kSureOfMore = 1e-6;

bool Contains(const std::vector<std::string>& group, const std::string& id) {
  return std::find(group.begin(), group.end(), id) != group.end();
}

/// One run of the chain over one set of Grams.
class Explainer {
 public:
  Explainer(const StrokeSet& strokes, const ExplainOptions& options, const CandidateModel& start)
      : strokes_(strokes),
        options_(options),
        start_(start),
        ranking_(strokes, options, start.fit.noise_variance * options.evidence_scale) {}

  Explanation Run();

 private:
  /// `share` times the share of the base model's excess may be left.
  bool AtFloor(const ExtendedFit& fit, double share = 1.0) const {
    return fit.excess_ratio <=
           options_.floor_excess + share * options_.left_share * std::max(0.0, start_.fit.excess_ratio);
  }
  /// Nothing is left that another law could explain: what it would gain is noise.
  bool IsBelowFloor(const ExtendedFit& fit) const { return fit.excess_ratio < -options_.floor_error; }
  /// Laws with one parameter have found a value that agrees with itself, as far as they were refined.
  bool IsLawful(const ExtendedFit& fit) const {
    return std::all_of(fit.effects.begin() + static_cast<std::ptrdiff_t>(start_.choices.size()),
                       fit.effects.end(), [&](const EffectEstimate& e) {
                         const bool refined =
                             strokes_.model().effect_shapes[e.choice.effect][e.choice.shape].refined;
                         return (e.consistent || !refined) && !ranking_.IsRefuted(e);
                       });
  }
  /// The model as it is leaves no more than noise, and none of the effects that stand out would not by chance.
  bool MayBeChance(const Explanation& found) const {
    return options_.IsDownToNoise(start_.fit) &&
           std::none_of(found.ranking.begin(), found.ranking.end(), [&](const RankedEffect& r) {
             return r.significant && (r.p_value < options_.chance_at_floor || ranking_.IsConfirmed(r.effect));
           });
  }
  const std::string& Id(const EffectChoice& choice) const {
    return strokes_.model().effects[choice.effect]->id;
  }
  std::vector<EffectChoice> Shapes(const EffectChoice& best) const;
  CandidateModel WithSecond(const CandidateModel& first, const RankedEffect& second) const;
  std::vector<EffectChoice> PairFirsts(std::vector<RankedEffect> ranking) const;
  std::optional<std::pair<CandidateModel, Groups>> SearchPairs(
      const std::vector<RankedEffect>& ranking) const;
  /// The model with the effects that explain the error, if some do; sets groups and second of `out`.
  std::optional<CandidateModel> Search(Explanation& out) const;
  void TakeSteps(const CandidateModel& model, Explanation& out) const;
  void FindRemainder(const CandidateModel& model, Explanation& out) const;
  void FindMargin(Explanation& out) const;
  void LookForRival(const CandidateModel& on, const std::vector<EffectChoice>& named, Explanation& out) const;
  bool IsSame(const RankedEffect& law, const CandidateModel& on,
              const std::vector<EffectChoice>& named) const;
  std::optional<std::pair<std::string, std::string>> Relatives(const Groups& groups) const;
  double LeastShare(const Explanation& found) const;
  Told ValueAtItsLimit(const Explanation& found) const;
  std::string MeasuredAndLeftOut(const ExtendedFit& fit) const;
  void LookForMore(Explanation& out) const;
  void Judge(Explanation& out) const;

  const StrokeSet& strokes_;
  const ExplainOptions& options_;
  const CandidateModel start_;
  const EffectRanking ranking_;
};

/// The effect in its best shape and in all that were refined: what suits a pair need not suit the effect
/// alone, nor agree with itself there.
std::vector<EffectChoice> Explainer::Shapes(const EffectChoice& best) const {
  std::vector<EffectChoice> choices = {best};
  for (const int shape : ShapesFor(strokes_.model(), best.effect, start_.choices))
    if (strokes_.model().effect_shapes[best.effect][shape].refined && shape != best.shape)
      choices.push_back({best.effect, shape});
  return choices;
}

/// The effects that gain most on their own, in all their shapes.
std::vector<EffectChoice> Explainer::PairFirsts(std::vector<RankedEffect> ranking) const {
  std::erase_if(ranking, [&](const RankedEffect& r) { return !r.fit.solved || r.gain <= options_.min_gain; });
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const RankedEffect& a, const RankedEffect& b) { return a.gain > b.gain; });
  std::vector<EffectChoice> firsts;
  for (std::size_t a = 0; a < std::min(options_.pair_firsts, ranking.size()); ++a)
    for (const EffectChoice& choice : Shapes(ranking[a].fit.effects.back().choice)) firsts.push_back(choice);
  return firsts;
}

/// The model that has both, in the shapes that suit them best together: as ranked, or with the first in another one.
CandidateModel Explainer::WithSecond(const CandidateModel& first, const RankedEffect& second) const {
  CandidateModel best = ranking_.With(first, second.fit.effects.back().choice);
  for (const EffectChoice& choice : Shapes(first.choices.back())) {
    const CandidateModel model = ranking_.With(start_, choice);
    const EffectChoice other =
        model.fit.solved ? strokes_.BestShape(second.effect, model.choices) : EffectChoice{0, -1};
    if (other.shape < 0) continue;
    CandidateModel both = ranking_.With(model, other);
    if (!std::all_of(both.fit.effects.begin(), both.fit.effects.end(),
                     [](const EffectEstimate& e) { return e.admissible; }))
      continue;
    const bool lawful = IsLawful(both.fit), was_lawful = IsLawful(best.fit);
    if (lawful != was_lawful ? lawful : both.fit.excess_ratio < best.fit.excess_ratio) best = std::move(both);
  }
  return best;
}

std::optional<std::pair<CandidateModel, Groups>> Explainer::SearchPairs(
    const std::vector<RankedEffect>& ranking) const {
  struct Pair {
    CandidateModel model;
    double gain;
    bool lawful;
    int confirmed;  ///< effects of it that were measured elsewhere
    int effect[2];
  };
  std::vector<Pair> pairs;
  for (const EffectChoice& choice : PairFirsts(ranking)) {
    const CandidateModel first = ranking_.With(start_, choice);
    if (!first.fit.solved) continue;
    for (const RankedEffect& second : ranking_.Rank(first)) {
      if (!second.fit.solved) continue;
      const std::size_t count = second.fit.effects.size();
      if (!ranking_.IsStrong(second.fit.effects[count - 1]) ||
          !ranking_.IsStrong(second.fit.effects[count - 2]))
        continue;
      Pair pair{{first.choices, second.fit},
                ranking_.Gain(ranking.front().fit, second.fit),
                IsLawful(second.fit),
                ranking_.IsConfirmed(choice.effect) + ranking_.IsConfirmed(second.effect),
                {choice.effect, second.effect}};
      pair.model.choices.push_back(second.fit.effects.back().choice);
      if (pair.gain > options_.min_gain) pairs.push_back(std::move(pair));
    }
  }
  if (pairs.empty()) return std::nullopt;
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
    if (x.lawful != y.lawful) return x.lawful;
    return x.confirmed != y.confirmed ? x.confirmed > y.confirmed : x.gain > y.gain;
  });
  const Pair& best = pairs.front();
  const double whole_gain = ranking_.Gain(start_.fit, best.model.fit);
  Groups groups = {{strokes_.model().effects[best.effect[0]]->id},
                   {strokes_.model().effects[best.effect[1]]->id}};
  // A rival pair that shares one effect offers its other effect as an alternative to the best pair's other one.
  for (std::size_t k = 1; k < pairs.size(); ++k) {
    const ExtendedFit &fit = pairs[k].model.fit, &best_fit = best.model.fit;
    if (std::any_of(fit.effects.begin(), fit.effects.end(),
                    [&](const EffectEstimate& e) { return ranking_.IsRefuted(e); }))
      continue;
    const bool rival = ranking_.IsRival(fit, best_fit, whole_gain);
    for (int mine = 0; mine < 2; ++mine)
      for (int theirs = 0; theirs < 2; ++theirs) {
        if (pairs[k].effect[1 - theirs] != best.effect[1 - mine] || ranking_.IsConfirmed(best.effect[mine]))
          continue;
        const std::string &other = strokes_.model().effects[pairs[k].effect[theirs]]->id,
                          &own = strokes_.model().effects[best.effect[mine]]->id;
        const bool twin = ranking_.IsTwin(other, fit, pairs[k].gain, own, best_fit, best.gain);
        if ((rival || twin) && !Contains(groups[mine], other)) groups[mine].push_back(other);
      }
  }
  return std::make_pair(best.model, groups);
}

std::optional<CandidateModel> Explainer::Search(Explanation& out) const {
  const RankedEffect& first = out.ranking.front();
  const CandidateModel model = ranking_.With(start_, first.fit.effects.back().choice);
  if (!first.significant || !AtFloor(model.fit)) {
    if (auto pair = SearchPairs(out.ranking)) {
      out.groups = std::move(pair->second);
      return std::move(pair->first);
    }
  }
  if (!first.significant) return std::nullopt;
  out.groups = {ranking_.Rivals(out.ranking, true)};
  if (!AtFloor(model.fit)) return model;
  out.second = ranking_.Rank(model);
  if (IsBelowFloor(model.fit) || out.second.empty() || !out.second.front().significant ||
      options_.max_effects < 2)
    return model;
  const RankedEffect& second = out.second.front();
  if (!ranking_.IsStrong(second.fit.effects.back())) return model;
  out.groups = {ranking_.Rivals(out.ranking, false), ranking_.Rivals(out.second, true)};
  return WithSecond(model, second);
}

void Explainer::TakeSteps(const CandidateModel& model, Explanation& out) const {
  out.final = model.fit;
  out.chosen = model.choices;
  for (std::size_t k = start_.choices.size(); k < model.choices.size(); ++k) {
    const ExtendedFit partial = strokes_.Fit(std::span(model.choices).first(k + 1));
    out.steps.push_back({Id(model.choices[k]), partial.rms_holdout, partial.excess_ratio});
  }
}

/// The right law leaves no scraps for another to pick up.
void Explainer::FindRemainder(const CandidateModel& model, Explanation& out) const {
  if (IsBelowFloor(model.fit)) return;
  for (const auto& further : {ranking_.Rank(model), ranking_.RankGeneric(model)}) {
    if (further.empty() || !further.front().fit.solved || further.front().gain <= out.remainder) continue;
    out.remainder = further.front().gain;
    out.remainder_law = further.front().id;
  }
}

/// Generic laws stand for effects that are not in the library. One that explains the error as well as what
/// was found, or as one of two effects beside the other, and is not much the same as that effect, shows that the name rests on
/// what happens to be in the library.
void Explainer::FindMargin(Explanation& out) const {
  out.margin = std::numeric_limits<double>::infinity();
  const auto started = static_cast<std::size_t>(out.started);
  const bool single = out.chosen.size() == started + 1;
  if (!single) LookForRival(start_, {}, out);
  for (std::size_t k = started; k < out.chosen.size(); ++k) {
    CandidateModel others{out.chosen, {}};
    others.choices.erase(others.choices.begin() + static_cast<std::ptrdiff_t>(k));
    others.fit = strokes_.Fit(others.choices);
    std::vector<EffectChoice> named = {out.chosen[k]};
    if (single)
      for (const RankedEffect& r : out.ranking)
        if (r.fit.solved && Contains(out.groups.front(), r.id)) named.push_back(r.fit.effects.back().choice);
    if (others.fit.solved) LookForRival(others, named, out);
  }
}

/// The best generic law on top of `on` that is not much the same as one of `named`, if it comes closer than those before.
void Explainer::LookForRival(const CandidateModel& on, const std::vector<EffectChoice>& named,
                             Explanation& out) const {
  for (const RankedEffect& law : ranking_.RankGeneric(on)) {
    if (!law.fit.solved) return;
    if (IsSame(law, on, named)) continue;
    const double margin = ranking_.Gain(law.fit, out.final);
    if (margin >= out.margin) return;
    out.margin = margin;
    out.margin_law = law.id;
    return;
  }
}

/// Little of the law is left beside an effect that may be the one. An edge or a spool sensor that is not linear may have the very
/// columns of a choked line and is another cause all the same.
bool Explainer::IsSame(const RankedEffect& law, const CandidateModel& on,
                       const std::vector<EffectChoice>& named) const {
  const Effect& effect = *strokes_.model().effects[law.effect];
  if (effect.plain_flow && effect.walks) return false;
  const double least =
      (effect.plain_flow ? options_.same_flow : options_.same_law) * law.fit.effects.back().independent;
  return std::any_of(named.begin(), named.end(), [&](const EffectChoice& choice) {
    const ExtendedFit both = ranking_.With(ranking_.With(on, choice), law.fit.effects.back().choice).fit;
    return !both.solved || both.effects.back().independent < least;
  });
}

/// Two effects found at once of which one, or its twin, is easily taken for the other.
std::optional<std::pair<std::string, std::string>> Explainer::Relatives(const Groups& groups) const {
  if (groups.size() != 2) return std::nullopt;
  const auto is_or_is_twin = [&](const std::string& id, const std::string& a) {
    return id == a || ShareOfTwins(strokes_.model(), id, a);
  };
  const auto confused = [&](const std::string& a, const std::string& b) {
    return std::any_of(strokes_.model().effects.begin(), strokes_.model().effects.end(), [&](const auto& e) {
      return is_or_is_twin(e->id, a) &&
             std::any_of(e->confused_with.begin(), e->confused_with.end(),
                         [&](const std::string& other) { return is_or_is_twin(other, b); });
    });
  };
  const std::string &a = groups[0].front(), &b = groups[1].front();
  if (!confused(a, b) && !confused(b, a)) return std::nullopt;
  return std::make_pair(a, b);
}

/// Share of the gain that would be lost with the effect that matters least; 1 if only one was found.
double Explainer::LeastShare(const Explanation& found) const {
  const auto started = static_cast<std::size_t>(found.started);
  if (found.chosen.size() < started + 2) return 1;
  const double gain = ranking_.Gain(start_.fit, found.final);
  double least = 1;
  for (std::size_t k = started; k < found.chosen.size(); ++k) {
    std::vector<EffectChoice> others = found.chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const ExtendedFit without = strokes_.Fit(others);
    if (without.solved) least = std::min(least, ranking_.Gain(without, found.final) / gain);
  }
  return least;
}

/// A value that the data would rather have beyond what its law allows: they follow another law. "" if there is none.
Told Explainer::ValueAtItsLimit(const Explanation& found) const {
  for (auto k = static_cast<std::size_t>(found.started); k < found.chosen.size(); ++k) {
    const Effect& effect = *strokes_.model().effects[found.chosen[k].effect];
    const EffectShape& shape = strokes_.model().effect_shapes[found.chosen[k].effect][found.chosen[k].shape];
    if (!shape.refined || effect.implied) continue;
    for (std::size_t i = 0; i < shape.nonlinear.size(); ++i) {
      const NonlinearParameter& value = effect.nonlinear[i];
      const double margin = options_.limit_share * (value.max - value.min);
      if (value.std > 0 || effect.grid.empty() ||
          (shape.nonlinear[i] > value.min + margin && shape.nonlinear[i] < value.max - margin))
        continue;
      return Tell(
          "{} of {} comes out at the limit of what it may be: another law of this kind may be at work",
          "{} von {} liegt an der Grenze des Zulässigen: es kann ein anderes Gesetz dieser Art sein",
          value.name, effect.id);
    }
  }
  return {};
}

/// An effect that a test off the log says is there, and that is not in the model; "" if there is none.
std::string Explainer::MeasuredAndLeftOut(const ExtendedFit& fit) const {
  const auto& effects = strokes_.model().effects;
  for (int e = 0; e < static_cast<int>(effects.size()); ++e)
    if (ranking_.IsConfirmed(e) && std::none_of(fit.effects.begin(), fit.effects.end(),
                                                [&](const auto& in) { return in.choice.effect == e; }))
      return effects[static_cast<std::size_t>(e)]->id;
  return "";
}

/// Near the floor is not at it: a law, named or not, that gains too little for a name but cannot be chance says that something
/// is missing, which may be another law that is not in the library.
void Explainer::LookForMore(Explanation& out) const {
  for (const auto& laws : {out.ranking, ranking_.RankGeneric(start_)})
    for (const RankedEffect& law : laws)
      if (law.fit.solved && law.p_value < kSureOfMore &&
          law.gain > std::max(options_.doubt_remainder, out.remainder)) {
        out.remainder = law.gain;
        out.remainder_law = law.id;
      }
  if (out.remainder_law.empty()) return;
  out.verdict = Verdict::kUnknown;
  out.doubt =
      Tell("a small error is sure, which another law would explain in part ({}), too little of it for a name",
           "ein kleiner Fehler ist sicher, den ein anderes Gesetz zum Teil erklären würde ({}), zu wenig für "
           "einen Namen",
           out.remainder_law);
}

void Explainer::Judge(Explanation& out) const {
  const double gain = ranking_.Gain(start_.fit, out.final);
  const double more = out.groups.size() > 1 ? options_.interplay : 1.0;
  if (!AtFloor(out.final, more) || !IsLawful(out.final) || out.remainder > options_.MayRemain(gain, more)) {
    out.verdict = Verdict::kUnknown;
    out.partial = true;
    out.groups.clear();
    return;
  }
  if (const std::string known = MeasuredAndLeftOut(out.final); !known.empty()) {
    out.doubt = Tell(
        "the test off the log says that {} is there, which is not in this model: it may be part of the size found",
        "die Prüfung ohne Log sagt, dass {} da ist, was in diesem Modell fehlt: die gefundene Größe kann es enthalten",
        known);
  } else if (!AtFloor(out.final) || out.remainder > options_.doubt_remainder + options_.doubt_share * gain) {
    out.doubt = Tell("it leaves something that another law would explain ({})",
                     "es bleibt etwas, das ein anderes Gesetz erklären würde ({})", out.remainder_law);
  } else if (out.final.excess_ratio > options_.doubt_excess) {
    out.doubt = Tell("it leaves {:.0f} % more energy than sensor noise",
                     "es bleiben {:.0f} % mehr Energie als das Sensorrauschen", 100 * out.final.excess_ratio);
  } else if (out.margin < options_.doubt_margin) {
    out.doubt = Tell("a law without a name explains the error as well ({})",
                     "ein Gesetz ohne Namen erklärt den Fehler ebenso gut ({})", out.margin_law);
  } else if (MayBeChance(out)) {
    out.doubt = Tell(
        "without it the error is no larger than noise, and of so many effects one may stand out by chance",
        "ohne ihn ist der Fehler nicht größer als das Rauschen, und von so vielen Effekten kann einer "
        "zufällig hervortreten");
  } else if (Told limit = ValueAtItsLimit(out); !limit.empty()) {
    out.doubt = std::move(limit);
  } else if (const auto blend = Relatives(out.groups)) {
    out.doubt = Tell("{} and {} have similar signatures, and together they can pass for a third law",
                     "{} und {} haben ähnliche Spuren und können zusammen als ein drittes Gesetz durchgehen",
                     blend->first, blend->second);
  } else if (const double least = LeastShare(out); least < options_.small_second) {
    out.doubt = Tell(
        "one of the effects makes {:.1f} % of the difference only, as much as the other may owe to a "
        "law that is not quite its own",
        "einer der Effekte macht nur {:.1f} % des Unterschieds aus, so viel wie am anderen liegen kann, wenn dessen "
        "Gesetz nicht ganz zutrifft",
        100 * least);
  }
  out.partial = !out.doubt.empty();
  for (const auto& group : out.groups) out.set.push_back(group.front());
  for (const auto& group : out.groups)
    for (const std::string& id : group)
      if (!Contains(out.set, id)) out.set.push_back(id);
  const bool ambiguous =
      std::any_of(out.groups.begin(), out.groups.end(), [](const auto& g) { return g.size() > 1; });
  out.verdict = ambiguous ? Verdict::kAmbiguous : Verdict::kNamed;
}

Explanation Explainer::Run() {
  Explanation out = BeginExplanation(strokes_, options_, start_, ranking_);
  if (!out.base.solved) return out;
  const bool stands_out = !out.ranking.empty() && out.ranking.front().significant;
  const bool at_floor = out.base.excess_ratio <= options_.floor_excess;
  std::optional<CandidateModel> model;
  if (stands_out || (!at_floor && !out.ranking.empty() && out.ranking.front().fit.solved))
    model = Search(out);
  if (!model) {
    out.verdict = at_floor ? Verdict::kAdequate : Verdict::kUnknown;
    if (at_floor) LookForMore(out);
    return out;
  }
  TakeSteps(*model, out);
  FindRemainder(*model, out);
  FindMargin(out);
  Judge(out);
  return out;
}

bool SameEffects(const std::vector<EffectChoice>& a, const std::vector<EffectChoice>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const EffectChoice& x, const EffectChoice& y) { return x.effect == y.effect; });
}

/// The chain with its evidence counted in what a law gains by chance: as many noise variances as sizes of laws scatter more
/// between strokes, on what the model found leaves, than in the logs that the thresholds were set on. Effects that stand so as
/// well keep their rivals: sizes also scatter because a leak grows, which does not make it another law.
Explanation ExplainByStrokes(const StrokeSet& strokes, const ExplainOptions& options,
                             const CandidateModel& start) {
  Explanation out = Explainer(strokes, options, start).Run();
  if (!out.final.solved || out.chosen.size() == start.choices.size()) return out;
  const EffectRanking ranking(strokes, options, start.fit.noise_variance);
  ExplainOptions counted = options;
  counted.evidence_scale = ranking.DesignEffect({out.chosen, out.final}) / options.white_correlation;
  if (counted.evidence_scale < (1 + options.evidence_growth) * options.evidence_scale) return out;
  Explanation recounted = Explainer(strokes, counted, start).Run();
  if (recounted.partial || !SameEffects(recounted.chosen, out.chosen)) return recounted;
  out.evidence_scale = counted.evidence_scale;
  return out;
}

/// A name that does not lower the error on strokes left out, in the units shown, step by step, is none.
void RefuseWhatDoesNotLowerTheError(Explanation& out) {
  if (out.set.empty() || out.steps.size() < 2) return;
  const double reached = out.steps.back().rms_holdout;
  if (std::all_of(out.steps.begin(), out.steps.end() - 1,
                  [&](const auto& before) { return reached < before.rms_holdout; }))
    return;
  out.verdict = Verdict::kUnknown;
  out.partial = true;
  out.set.clear();
  out.groups.clear();
}

/// The intervals of the models before and after, where strokes hang together; the search is done. Those of
/// the ranking stay by stroke, as it was weighed.
void WidenShown(const StrokeSet& strokes, Explanation& out) {
  const auto widen = [&](ExtendedFit& fit) {
    std::vector<EffectChoice> choices;
    for (const EffectEstimate& e : fit.effects) choices.push_back(e.choice);
    strokes.Widen(choices, fit);
  };
  widen(out.base);
  widen(out.final);
}

}  // namespace

const char* VerdictName(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAdequate:
      return "adequate";
    case Verdict::kNamed:
      return "named";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kUnknown:
      return "unknown";
  }
  return "unknown";
}

Explanation Explain(const StrokeSet& strokes, const ExplainOptions& options) {
  const std::optional<StrokeSet> comparable = strokes.Comparable();
  const StrokeSet& used = comparable ? *comparable : strokes;
  const CandidateModel start = StartModel(used, options.start);
  Explanation out = IsOwnMachine(used.model()) ? ExplainBySubsets(used, options, start)
                                               : ExplainByStrokes(used, options, start);
  RefuseWhatDoesNotLowerTheError(out);
  WidenShown(used, out);
  return out;
}

}  // namespace hydroscope
