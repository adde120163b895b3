#include "diagnosis/explain_own_machine.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/contains.h"
#include "diagnosis/subset_search.h"
#include "estimation/gram_fit.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

using Effects = std::vector<int>;  ///< of a model, without those of the start model

Effects Added(const CandidateModel& model, std::size_t started) {
  Effects out;
  for (std::size_t k = started; k < model.choices.size(); ++k) out.push_back(model.choices[k].effect);
  return out;
}

Effects Without(const Effects& all, const Effects& shared) {
  Effects out;
  for (const int e : all)
    if (!Contains(shared, e)) out.push_back(e);
  return out;
}

/// Explains one set of strokes of a machine of the user's own.
class OwnMachineExplainer {
 public:
  OwnMachineExplainer(const StrokeSet& strokes, const ExplainOptions& options, const CandidateModel& start)
      : strokes_(strokes),
        options_(options),
        start_(start),
        ranking_(strokes, options, start.fit.noise_variance * options.evidence_scale) {}

  Explanation Run() {
    Explanation out = BeginExplanation(strokes_, options_, start_, ranking_);
    if (!out.base.solved) return out;
    const SubsetResult found = SearchSubsets(strokes_, start_, Candidates(), Options());
    const bool at_floor = out.base.excess_ratio <= options_.floor_excess;
    const bool nothing_found = found.best.choices.size() == start_.choices.size();
    const std::vector<RankedEffect> laws =
        at_floor && nothing_found ? std::vector<RankedEffect>{} : GeneralLaws(out.ranking);
    if (!at_floor) ProposeLaws(laws, out);
    if (nothing_found) {
      out.verdict = at_floor ? Verdict::kAdequate : Verdict::kUnknown;
      return out;
    }
    TakeSteps(found.best, out);
    out.groups = Groups(found, out);
    Judge(out);
    if (out.verdict != Verdict::kUnknown) ObjectIfAGeneralLawIsBetter(laws, out);
    if (out.verdict != Verdict::kUnknown && !out.partial) DoubtIfAnyCurve(out);
    if (out.verdict != Verdict::kUnknown) TellWhatIsLeft(out);
    return out;
  }

 private:
  SubsetOptions Options() const {
    SubsetOptions out;
    out.min_t = options_.min_t;
    out.min_gain = options_.min_gain * options_.evidence_scale;
    return out;
  }

  std::vector<int> Candidates() const {
    std::vector<int> out;
    const auto& library = strokes_.model().effects;
    for (int e = 0; e < static_cast<int>(library.size()); ++e) {
      const bool used = std::any_of(start_.choices.begin(), start_.choices.end(),
                                    [&](const EffectChoice& c) { return c.effect == e; });
      const bool excluded = Contains(options_.exclude, library[e]->id);
      if (!used && !excluded && !library[e]->generic) out.push_back(e);
    }
    return out;
  }

  /// Laws of general shape, but for those that are much the same as one of the machine file's effects, `ranking`.
  std::vector<RankedEffect> GeneralLaws(const std::vector<RankedEffect>& ranking) const {
    std::vector<RankedEffect> out;
    for (RankedEffect& law : ranking_.RankGeneric(start_)) {
      if (!law.fit.solved) continue;
      const EffectEstimate& alone = law.fit.effects.back();
      const bool same = std::ranges::any_of(ranking, [&](const RankedEffect& named) {
        if (!named.fit.solved) return false;
        const ExtendedFit both =
            ranking_.With(ranking_.With(start_, named.fit.effects.back().choice), alone.choice).fit;
        return !both.solved || both.effects.back().independent < options_.same_flow * alone.independent;
      });
      if (!same) out.push_back(std::move(law));
    }
    return out;
  }

  double MostLeft(const Explanation& out) const {
    return options_.floor_excess + options_.left_share * std::max(0.0, out.base.excess_ratio);
  }

  /// The first of `laws`, which are best first, that explains the error, and those that do so about as well.
  void ProposeLaws(const std::vector<RankedEffect>& laws, Explanation& out) const {
    for (const RankedEffect& law : laws) {
      const bool explains = law.significant && law.fit.excess_ratio <= MostLeft(out);
      if (!explains || out.proposed.size() == options_.most_proposed ||
          !ranking_.IsRival(law.fit, laws.front().fit, laws.front().gain))
        continue;
      const Effect& effect = *strokes_.model().effects[law.effect];
      const bool falls = law.fit.effects.back().size < 0;
      out.proposed.push_back(
          {(falls ? "-" : "") + effect.title, effect.late_signal, law.fit.rms_holdout, law.fit.excess_ratio});
    }
  }

  /// A name rests on what happens to be in the machine file where laws that nobody wrote down, in place of effects found, do
  /// better, or as well with fewer.
  void ObjectIfAGeneralLawIsBetter(const std::vector<RankedEffect>& laws, Explanation& out) const {
    const Effects named = Added({out.chosen, {}}, static_cast<std::size_t>(out.started));
    if (laws.empty()) return;
    Effects candidates = named;
    for (const RankedEffect& law : laws) candidates.push_back(law.effect);
    SubsetOptions options = Options();
    options.max_effects = static_cast<int>(named.size());
    options.max_candidates = static_cast<int>(candidates.size());
    const SubsetResult found = SearchSubsets(strokes_, start_, candidates, options);
    std::vector<std::string> without_name;
    for (const int e : Without(Added(found.best, start_.choices.size()), named))
      without_name.push_back(strokes_.model().effects[e]->title);
    if (without_name.empty()) return;
    const Eigen::VectorXd worse = Worse(out.final, found.best.fit);
    const double unit = found.best.fit.noise_variance * (1 + std::max(0.0, found.best.fit.excess_ratio));
    const bool fewer = found.best.choices.size() < out.chosen.size();
    if (worse.size() == 0 || (worse.sum() < options.rival_gain * unit && !fewer)) return;
    out.partial = true;
    out.margin_law = fmt::to_string(fmt::join(without_name, ", "));
    out.doubt = Tell("what goes with {} explains the error better, and no effect of the machine file does",
                     "was mit {} geht, erklärt den Fehler besser, und kein Effekt der Maschinendatei tut es",
                     out.margin_law);
    const bool far_worse = out.final.rms_holdout > options.far_worse * found.best.fit.rms_holdout;
    if (!far_worse && !IsSure(worse, out)) return;
    out.nameless = found.best.fit.excess_ratio <= options_.floor_excess;
    out.verdict = Verdict::kUnknown;
    out.set.clear();
    out.groups.clear();
  }

  /// Several effects over one signal, named now or before, may be no more than the curve of one that is missing.
  void DoubtIfAnyCurve(Explanation& out) const {
    std::map<std::string, std::vector<std::string>> over;
    for (const EffectChoice& choice : out.chosen)
      if (const Effect& effect = *strokes_.model().effects[choice.effect]; effect.reads.size() == 1)
        over[effect.reads.front()].push_back(effect.id);
    for (const auto& [signal, ids] : over) {
      const bool named = std::ranges::any_of(ids, [&](const auto& id) { return Contains(out.set, id); });
      if (!named || ids.size() < options_.any_curve) continue;
      out.partial = true;
      out.doubt = Tell(
          "{} all go with {} alone: together they draw the curve of any law of it, also of one that the "
          "machine file lacks",
          "{} gehen alle mit {} allein: zusammen zeichnen sie die Kurve jedes Gesetzes davon, auch eines, das der "
          "Maschinendatei fehlt",
          fmt::to_string(fmt::join(ids, ", ")), signal);
    }
  }

  /// Beside what is named a law may be missing: something of general shape is in what is left, for sure.
  void TellWhatIsLeft(Explanation& out) const {
    for (const RankedEffect& law : ranking_.RankGeneric({out.chosen, out.final})) {
      if (!law.significant || law.p_value > options_.sure_of_more || !IsSure(Worse(out.final, law.fit), out))
        continue;
      out.remainder = law.gain;
      out.remainder_law = strokes_.model().effects[law.effect]->title;
      out.warnings.push_back(Tell(
          "beside what is named something else is missing, which no effect of the machine file explains: it goes with {}",
          "neben dem Genannten fehlt noch etwas, das kein Effekt der Maschinendatei erklärt: es geht mit {}",
          out.remainder_law));
      return;
    }
  }

  /// Whether an error that is larger stroke by stroke, `worse`, is so for sure, by the groups in which strokes hang together.
  bool IsSure(const Eigen::VectorXd& worse, const Explanation& out) const {
    ExtendedFit fit = out.final;
    strokes_.Widen(out.chosen, fit);
    const StrokeClusters clusters = fit.clusters.of.size() == static_cast<std::size_t>(worse.size())
                                        ? fit.clusters
                                        : SingleStrokes(static_cast<std::size_t>(worse.size()));
    if (clusters.count < 2) return false;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(clusters.count);
    for (Eigen::Index s = 0; s < worse.size(); ++s) sum[clusters.of[static_cast<std::size_t>(s)]] += worse[s];
    const double n = clusters.count;
    const double error = std::sqrt((sum.array() - sum.mean()).square().sum() / (n - 1) / n);
    return sum.mean() > Options().better_t * StudentFactor(n - 1) * error;
  }

  const std::string& Id(int effect) const { return strokes_.model().effects[effect]->id; }

  /// Adds the effects of the subset one by one, each time the one that lowers the error most.
  void TakeSteps(const CandidateModel& best, Explanation& out) const {
    std::vector<EffectChoice> left(best.choices.begin() + out.started, best.choices.end());
    CandidateModel model = start_;
    while (!left.empty()) {
      std::size_t first = 0;
      CandidateModel least = ranking_.With(model, left[0]);
      for (std::size_t k = 1; k < left.size(); ++k) {
        CandidateModel with = ranking_.With(model, left[k]);
        if (!with.fit.solved || (least.fit.solved && with.fit.rms_holdout >= least.fit.rms_holdout)) continue;
        least = std::move(with);
        first = k;
      }
      model = std::move(least);
      out.steps.push_back({Id(left[first].effect), model.fit.rms_holdout, model.fit.excess_ratio});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(first));
    }
    out.chosen = model.choices;
    out.final = std::move(model.fit);
  }

  /// One group per effect of the best subset; where a rival subset has others, they stand for those of the
  /// best that it lacks, in the order of adding.
  std::vector<std::vector<std::string>> Groups(const SubsetResult& found, const Explanation& out) const {
    const auto started = static_cast<std::size_t>(out.started);
    const Effects best = Added({out.chosen, {}}, started);
    std::vector<std::vector<std::string>> groups;
    for (const int e : best) groups.push_back({Id(e)});
    for (const CandidateModel& rival : found.rivals) {
      const Effects theirs = Added(rival, started);
      const Effects missing = Without(best, theirs), instead = Without(theirs, best);
      for (std::size_t k = 0; k < instead.size() && k < missing.size(); ++k) {
        auto& group =
            groups[static_cast<std::size_t>(std::find(best.begin(), best.end(), missing[k]) - best.begin())];
        if (!Contains(group, Id(instead[k]))) group.push_back(Id(instead[k]));
      }
    }
    return groups;
  }

  void Judge(Explanation& out) const {
    if (out.final.excess_ratio > MostLeft(out)) {
      out.verdict = Verdict::kUnknown;
      out.partial = true;
      out.groups.clear();
      return;
    }
    for (const auto& group : out.groups) out.set.push_back(group.front());
    bool ambiguous = false;
    for (const auto& group : out.groups)
      for (const std::string& id : group) {
        ambiguous = ambiguous || group.size() > 1;
        if (!Contains(out.set, id)) out.set.push_back(id);
      }
    out.verdict = ambiguous ? Verdict::kAmbiguous : Verdict::kNamed;
  }

  const StrokeSet& strokes_;
  const ExplainOptions& options_;
  const CandidateModel start_;
  const EffectRanking ranking_;
};

}  // namespace

bool IsOwnMachine(const ModelStructure& model) { return model.kind != nullptr && model.kind->own_library; }

Explanation ExplainBySubsets(const StrokeSet& strokes, const ExplainOptions& options,
                             const CandidateModel& start) {
  return OwnMachineExplainer(strokes, options, start).Run();
}

}  // namespace hydroscope
