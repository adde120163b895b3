#include "diagnosis/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/constants.h"
#include "core/contains.h"
#include "diagnosis/doubts.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/explain_own_machine.h"
#include "diagnosis/moved_parameter.h"
#include "diagnosis/nameless_rival.h"
#include "diagnosis/noise_of_halves.h"

namespace hydroscope {
namespace {

using Groups = std::vector<std::vector<std::string>>;

/// Error energy per equation that ExplainOptions::trifle comes to.
double TrifleOf(const StrokeSet& strokes, const ExplainOptions& options) {
  return options.trifle * options.trifle * strokes.OutputEnergy() / strokes.equations();
}

/// On the model as it is sizes scatter also by what it misses: what can be told beside what was found can be told.
void TakeAsTested(const std::vector<RankedEffect>& beside, Explanation& out) {
  for (RankedEffect& ranked : out.ranking) {
    const auto tested = std::ranges::find(beside, ranked.id, &RankedEffect::id);
    if (ranked.testable || !ranked.fit.solved || tested == beside.end() || !tested->testable) continue;
    ranked.testable = true;
    ranked.why_not = {};
  }
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
  /// An effect in the place of one that was found leaves so little more that by itself it would have passed the gate.
  bool MayTakeThePlace(const ExtendedFit& fit, const ExtendedFit& found) const {
    const double more = fit.excess_ratio - std::max(0.0, found.excess_ratio);
    return fit.solved &&
           more <= options_.floor_excess + options_.left_share * std::max(0.0, start_.fit.excess_ratio);
  }
  const std::string& Id(const EffectChoice& choice) const {
    return strokes_.model().effects[choice.effect]->id;
  }
  std::vector<EffectChoice> ShapesToTry(const EffectChoice& best) const;
  CandidateModel WithSecond(const CandidateModel& first, const RankedEffect& second) const;
  std::vector<EffectChoice> PairFirsts(std::vector<RankedEffect> ranking) const;
  std::optional<std::pair<CandidateModel, Groups>> SearchPairs(
      const std::vector<RankedEffect>& ranking) const;
  /// The model with the effects that explain the error, if some do; sets groups and second of `out`.
  std::optional<CandidateModel> Search(Explanation& out) const;
  void TakeSteps(const CandidateModel& model, Explanation& out) const;
  void AddSharers(const CandidateModel& model, Explanation& out) const;
  void FindRemainder(const CandidateModel& model, Explanation& out) const;
  Told PairThatLeavesLess(const Explanation& out) const;
  void LookForMore(Explanation& out) const;
  void LookForBias(Explanation& out) const;
  void Judge(Explanation& out) const;

  const StrokeSet& strokes_;
  const ExplainOptions& options_;
  const CandidateModel start_;
  const EffectRanking ranking_;
};

/// The effect in its best shape and in all that were refined: what suits a pair need not suit the effect
/// alone, nor agree with itself there.
std::vector<EffectChoice> Explainer::ShapesToTry(const EffectChoice& best) const {
  std::vector<EffectChoice> choices = {best};
  for (const int shape : ShapesFor(strokes_.model(), best.effect, start_.choices))
    if (strokes_.model().effect_shapes[best.effect][shape].refined && shape != best.shape)
      choices.push_back({best.effect, shape});
  return choices;
}

/// The effects that gain most on their own, in all their shapes.
std::vector<EffectChoice> Explainer::PairFirsts(std::vector<RankedEffect> ranking) const {
  std::erase_if(ranking,
                [&](const RankedEffect& r) { return !r.fit.solved || r.gain <= options_.LeastGain(); });
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const RankedEffect& a, const RankedEffect& b) { return a.gain > b.gain; });
  std::vector<EffectChoice> firsts;
  for (std::size_t a = 0; a < std::min(options_.pair_firsts, ranking.size()); ++a)
    for (const EffectChoice& choice : ShapesToTry(ranking[a].fit.effects.back().choice))
      firsts.push_back(choice);
  return firsts;
}

/// The model that has both, in the shapes that suit them best together: as ranked, or with the first in another one.
CandidateModel Explainer::WithSecond(const CandidateModel& first, const RankedEffect& second) const {
  CandidateModel best = ranking_.With(first, second.fit.effects.back().choice);
  for (const EffectChoice& choice : ShapesToTry(first.choices.back())) {
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
  const auto pair_with = [&](const EffectChoice& choice) {
    const CandidateModel first = ranking_.With(start_, choice);
    if (!first.fit.solved) return;
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
      if (pair.gain > options_.LeastGain()) pairs.push_back(std::move(pair));
    }
  };
  const std::vector<EffectChoice> firsts = PairFirsts(ranking);
  for (const EffectChoice& choice : firsts) pair_with(choice);
  if (pairs.empty()) return std::nullopt;
  // Of gains that are the same but for less than a noise variance the effects' own gains decide: firsts come in their order.
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
    if (x.lawful != y.lawful) return x.lawful;
    return x.confirmed != y.confirmed ? x.confirmed > y.confirmed : std::round(x.gain) > std::round(y.gain);
  });
  const Pair best = std::move(pairs.front());
  pairs.erase(pairs.begin());
  // An effect that says little by itself is no first: what may stand in the place of its partner is tried beside it.
  if (std::ranges::none_of(firsts, [&](const EffectChoice& c) { return c.effect == best.effect[1]; }))
    for (const EffectChoice& choice : ShapesToTry(best.model.choices.back())) pair_with(choice);
  const double whole_gain = ranking_.Gain(start_.fit, best.model.fit);
  Groups groups = {{strokes_.model().effects[best.effect[0]]->id},
                   {strokes_.model().effects[best.effect[1]]->id}};
  // A rival pair that shares one effect offers its other effect as an alternative to the best pair's other one.
  for (const Pair& pair : pairs) {
    const ExtendedFit& fit = pair.model.fit;
    if (std::ranges::any_of(fit.effects, [&](const EffectEstimate& e) { return ranking_.IsRefuted(e); }))
      continue;
    for (int mine = 0; mine < 2; ++mine)
      for (int theirs = 0; theirs < 2; ++theirs) {
        if (pair.effect[1 - theirs] != best.effect[1 - mine] || ranking_.IsConfirmed(best.effect[mine]))
          continue;
        const std::string& other = strokes_.model().effects[pair.effect[theirs]]->id;
        const bool stays = ranking_.StaysBeside({pair.effect[theirs], &fit, pair.gain},
                                                {best.effect[mine], &best.model.fit, best.gain}, whole_gain);
        if (stays && !Contains(groups[mine], other)) groups[mine].push_back(other);
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
  out.groups = {ranking_.Rivals(start_, out.ranking, true)};
  if (!AtFloor(model.fit)) return model;
  out.second = ranking_.Rank(model);
  if (IsBelowFloor(model.fit) || out.second.empty() || !out.second.front().significant ||
      options_.max_effects < 2)
    return model;
  const RankedEffect& second = out.second.front();
  if (!ranking_.IsStrong(second.fit.effects.back())) return model;
  out.groups = {ranking_.Rivals(start_, out.ranking, false), ranking_.Rivals(model, out.second, true)};
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

/// An effect easily taken for one that was found may have a part in it: where the strokes let the two share what was found, a
/// third of it may be the other, and together they give the other more than its standard deviation, both stay. One that alone would
/// leave an error is not what was found.
void Explainer::AddSharers(const CandidateModel& model, Explanation& out) const {
  const auto& effects = strokes_.model().effects;
  for (std::size_t k = 0; k < out.groups.size(); ++k) {
    const auto at = static_cast<std::size_t>(out.started) + k;
    const Effect& own = *effects[out.chosen[at].effect];
    if (ranking_.IsConfirmed(out.chosen[at].effect)) continue;
    for (const RankedEffect& other : out.ranking) {
      const bool is_named = std::any_of(out.groups.begin(), out.groups.end(),
                                        [&](const auto& group) { return Contains(group, other.id); });
      if (is_named || !other.stands_out || !AreConfused(own, *effects[other.effect]) ||
          FreeNumbers(*effects[other.effect]) > FreeNumbers(own))
        continue;
      const EffectChoice choice = other.fit.effects.back().choice;
      std::vector<EffectChoice> in_its_place = model.choices;
      in_its_place[at] = choice;
      const CandidateModel both = ranking_.With(model, choice);
      if (!both.fit.solved || !MayTakeThePlace(strokes_.Fit(in_its_place), model.fit)) continue;
      const EffectEstimate &mine = both.fit.effects[at], &theirs = both.fit.effects.back();
      const bool apart = std::abs(mine.size) - kNormal95 * mine.std >
                         options_.sure_share * std::abs(model.fit.effects[at].size);
      if (!apart && std::abs(theirs.size) > theirs.std) out.groups[k].push_back(other.id);
    }
    for (const std::string& id : ranking_.SteadyBesideAnother(model, at))
      if (!Contains(out.groups[k], id)) out.groups[k].push_back(id);
  }
}

/// The right law leaves no scraps for another to pick up.
void Explainer::FindRemainder(const CandidateModel& model, Explanation& out) const {
  const std::vector<RankedEffect> beside = ranking_.Rank(model);
  TakeAsTested(beside, out);
  if (IsBelowFloor(model.fit)) return;
  for (const auto& further : {beside, ranking_.RankGeneric(model)}) {
    if (further.empty() || !further.front().fit.solved || further.front().gain <= out.remainder) continue;
    out.remainder = further.front().gain;
    out.remainder_law = further.front().id;
  }
}

/// Why an effect that was found alone is in doubt where it leaves more than the floor may be off: two at once leave less, by more than
/// a further law may gain. "" if it is not.
Told Explainer::PairThatLeavesLess(const Explanation& out) const {
  if (out.groups.size() != 1 || options_.max_effects < 2 || out.final.excess_ratio < options_.floor_error)
    return {};
  const auto pair = SearchPairs(out.ranking);
  if (!pair || !pair->first.fit.solved) return {};
  const double gain = ranking_.Gain(start_.fit, out.final);
  if (ranking_.Gain(out.final, pair->first.fit) < options_.doubt_remainder + options_.doubt_share * gain)
    return {};
  const std::string &a = pair->second[0].front(), &b = pair->second[1].front();
  if (Contains(out.groups.front(), a) || Contains(out.groups.front(), b)) return {};
  return Tell("{} and {} at once leave less", "{} und {} zugleich lassen weniger übrig", a, b);
}

/// Near the floor is not at it: a law, named or not, that gains too little for a name but cannot be chance says that something
/// is missing, which may be another law that is not in the library.
void Explainer::LookForMore(Explanation& out) const {
  for (const auto& laws : {out.ranking, ranking_.RankGeneric(start_)})
    for (const RankedEffect& law : laws)
      if (law.fit.solved && law.p_value < options_.sure_of_more &&
          law.gain > std::max(options_.doubt_remainder, out.remainder)) {
        out.remainder = law.gain;
        out.remainder_law = law.id;
      }
  if (out.remainder_law.empty()) return;
  out.verdict = Verdict::kUnknown;
  out.small_error = true;
  out.doubt =
      Tell("a small error is sure, which another law would explain in part ({}), too little of it for a name",
           "ein kleiner Fehler ist sicher, den ein anderes Gesetz zum Teil erklären würde ({}), zu wenig für "
           "einen Namen",
           out.remainder_law);
}

/// A trifle of the output is none of a parameter that hangs on it: an effect that is hardly chance and would move one by much says
/// that the model is not adequate.
void Explainer::LookForBias(Explanation& out) const {
  for (const RankedEffect& r : out.ranking) {
    if (!r.fit.solved || !r.lawful || !r.testable) continue;
    const bool sure = r.p_value < options_.sure_of_more;
    const bool likely = r.p_value < options_.bias_p && r.gain > options_.min_gain;
    if (!sure && !likely) continue;
    const auto moved = FindMovedParameter(strokes_.model(), start_.fit, r.fit, options_.biased);
    if (!moved || !(sure || moved->leaves_interval)) continue;
    out.verdict = Verdict::kUnknown;
    out.small_error = true;
    out.doubt = Tell(
        "a small error is {0}, too small to name its cause, and {1} hangs on it: it would change by {2} with {3}",
        "ein kleiner Fehler ist {0}, zu klein für den Namen seiner Ursache, "
        "und {1} hängt an ihm: mit {3} änderte es sich um {2}",
        sure ? Told("sure", "sicher") : Told("likely", "wahrscheinlich"), moved->name,
        ChangeTold(*strokes_.model().kind, *moved), r.id);
    return;
  }
}

void Explainer::Judge(Explanation& out) const {
  const auto refuse = [&out](Told why) {
    out.verdict = Verdict::kUnknown;
    out.partial = true;
    out.groups.clear();
    out.doubt = std::move(why);
  };
  const double gain = ranking_.Gain(start_.fit, out.final);
  const double more = out.groups.size() > 1 ? options_.interplay : 1.0;
  if (!AtFloor(out.final, more) || !IsLawful(out.final) || out.remainder > options_.MayRemain(gain, more))
    return refuse({});
  if (out.margin < -options_.beaten_margin)
    return refuse(Tell("a law without a name explains the error better ({})",
                       "ein Gesetz ohne Namen erklärt den Fehler besser ({})", out.margin_law));
  const Doubts doubts(strokes_, options_, start_, ranking_);
  if (out.final.excess_ratio > std::max(options_.doubt_excess, options_.most_left * start_.fit.excess_ratio))
    return refuse(doubts.Of(out, AtFloor(out.final)));
  const auto unseen = doubts.MayMoveBetweenRows(out);
  if (unseen) out.groups.erase(out.groups.begin() + static_cast<std::ptrdiff_t>(unseen->effect));
  if (unseen && unseen->integrated) out.warnings.push_back(unseen->why);
  if (out.groups.empty()) {
    out.verdict = unseen->integrated ? Verdict::kAdequate : Verdict::kUnknown;
    out.small_error = !unseen->integrated;
    if (out.small_error) out.doubt = unseen->why;
    return;
  }
  out.doubt = doubts.Of(out, AtFloor(out.final));
  if (out.doubt.empty()) out.doubt = PairThatLeavesLess(out);
  out.partial = !out.doubt.empty();
  if (out.partial && out.groups.size() == 1)
    out.groups = {ranking_.RivalsInDoubt(out.ranking, out.groups.front())};
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
  out.trifle = TrifleOf(strokes_, options_);
  if (!out.base.solved) return out;
  const bool stands_out = !out.ranking.empty() && out.ranking.front().significant;
  const bool at_floor = out.base.excess_ratio <= options_.floor_excess;
  std::optional<CandidateModel> model;
  if (stands_out || (!at_floor && !out.ranking.empty() && out.ranking.front().fit.solved))
    model = Search(out);
  if (!model) {
    out.verdict = at_floor ? Verdict::kAdequate : Verdict::kUnknown;
    if (at_floor) LookForMore(out);
    if (out.verdict == Verdict::kAdequate) LookForBias(out);
    return out;
  }
  TakeSteps(*model, out);
  AddSharers(*model, out);
  FindRemainder(*model, out);
  FindMargin(strokes_, options_, start_, ranking_, out);
  Judge(out);
  return out;
}

bool SameEffects(const std::vector<EffectChoice>& a, const std::vector<EffectChoice>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const EffectChoice& x, const EffectChoice& y) { return x.effect == y.effect; });
}

/// `options` with thresholds that a trifle does not pass.
ExplainOptions WithoutTrifles(const StrokeSet& strokes, ExplainOptions options, double noise_variance) {
  const double ratio = TrifleOf(strokes, options) / noise_variance;
  options.floor_excess += ratio;
  options.trifle_gain = ratio * strokes.equations() / options.evidence_scale;
  for (double* least : {&options.max_remainder, &options.doubt_remainder})
    *least = std::max(*least, options.trifle_gain);
  return options;
}

/// The chain with its evidence counted in what a law gains by chance: as many noise variances as sizes of laws scatter more
/// between strokes, on what the model found leaves, than in the logs that the thresholds were set on. Effects that stand so as
/// well keep their rivals: sizes also scatter because a leak grows, which does not make it another law.
Explanation ExplainByStrokes(const StrokeSet& strokes, const ExplainOptions& asked,
                             const CandidateModel& start) {
  const ExplainOptions options = WithoutTrifles(strokes, asked, start.fit.noise_variance);
  Explanation out = Explainer(strokes, options, start).Run();
  if (!out.final.solved || out.chosen.size() == start.choices.size()) return out;
  const EffectRanking ranking(strokes, options, start.fit.noise_variance);
  ExplainOptions counted = asked;
  counted.evidence_scale = ranking.DesignEffect({out.chosen, out.final}) / options.white_correlation;
  if (counted.evidence_scale < (1 + options.evidence_growth) * options.evidence_scale) return out;
  counted = WithoutTrifles(strokes, counted, start.fit.noise_variance);
  Explanation recounted = Explainer(strokes, counted, start).Run();
  if (recounted.partial || !SameEffects(recounted.chosen, out.chosen)) return recounted;
  out.evidence_scale = counted.evidence_scale;
  return out;
}

/// What was found is no name, for the reason given if there is one.
void RefuseName(Explanation& out, Told why = {}) {
  out.verdict = Verdict::kUnknown;
  out.partial = true;
  out.set.clear();
  out.groups.clear();
  if (!why.empty()) out.doubt = std::move(why);
}

/// A name that does not lower the error on strokes left out, in the units shown, step by step, is none.
void RefuseWhatDoesNotLowerTheError(Explanation& out) {
  if (out.set.empty() || out.steps.size() < 2) return;
  const double reached = out.steps.back().rms_holdout;
  if (std::all_of(out.steps.begin(), out.steps.end() - 1,
                  [&](const auto& before) { return reached < before.rms_holdout; }))
    return;
  RefuseName(out);
}

/// What is named is no effect that cannot be tested here.
void TakeNamedAsTested(Explanation& out) {
  for (RankedEffect& ranked : out.ranking) {
    if (!Contains(out.set, ranked.id)) continue;
    ranked.testable = true;
    ranked.why_not = {};
  }
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
  const ExtendedFit& fit = out.final.solved ? out.final : out.base;
  if (out.verdict != Verdict::kUnknown)
    if (Told why = WhyNoiseIsNotBelievable(used, start.choices, fit, options.noise_of_half); !why.empty())
      RefuseName(out, std::move(why));
  TakeNamedAsTested(out);
  WidenShown(used, out);
  return out;
}

}  // namespace hydroscope
