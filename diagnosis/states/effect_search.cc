#include "diagnosis/states/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "core/contains.h"
#include "core/parallel/in_parallel.h"
#include "core/told_error.h"
#include "diagnosis/states/found_sets.h"
#include "diagnosis/states/law_terms.h"
#include "diagnosis/states/search_conclusion.h"
#include "diagnosis/states/search_sentences.h"
#include "models/state_effects.h"

namespace hydroscope {
namespace {

class EffectSearch {
 public:
  explicit EffectSearch(FoundSets& found) : found_(found) {}

  /// False if the model as it is cannot be fitted.
  bool Run() {
    const auto model = BuildStateModel(machine_, machine_.added_effects);
    if (!model) {
      out_.base.fit.failed = ToldOf(model.error());
      return false;
    }
    out_.base.fit = FitFromAllStarts(*model);
    if (!out_.base.fit.solved()) return false;
    out_.base.held_out = out_.base.fit.HeldOutEnergy();
    out_.base_left = Left(out_.base.fit);
    fits_.emplace(machine_, episodes_, found_.starts_on, options_, out_.base);
    SearchAll();
    if (TakeBaseFromEffects()) SearchAll();
    return true;
  }

 private:
  StateFit FitFromAllStarts(const std::shared_ptr<const StateModel>& model) const {
    StateFitOptions best_alone = options_.fit;
    best_alone.until_white = true;
    best_alone.tells_start = [this](int start, std::size_t starts) {
      Tell(fmt::format("fits the model as it is, start {} of at most {}", start, starts));
    };
    if (found_.starts_on.size() == episodes_.size()) return FitStates(model, episodes_, best_alone);
    StateFit few = FitStates(model, Chosen(episodes_, found_.starts_on), best_alone);
    if (!few.solved()) return few;
    const StateStart start{few.parameters, {}};
    StateFit all = RefitStates(model, episodes_, std::span(&start, 1), {}, options_.fit);
    all.minima = std::move(few.minima);
    all.starts_tried = few.starts_tried;
    all.starts_diverged = few.starts_diverged;
    return all;
  }
  StateRemainder Left(const StateFit& fit) const { return found_.Left(fit); }
  void Tell(const std::string& what) const {
    if (options_.tells) options_.tells(what);
  }

  template <class Items, class Wanted>
  static auto Some(const Items& items, const Wanted& wanted) {
    std::vector<std::reference_wrapper<const std::ranges::range_value_t<Items>>> some;
    for (const auto& item : items)
      if (wanted(item)) some.emplace_back(item);
    return some;
  }
  /// What `fit` gives for each of some sets, in their order; on several threads. `how` is told.
  template <class Some, class Fit>
  auto Each(const char* how, const Some& some, const Fit& fit) const {
    std::atomic<int> begun = 0;
    return InParallel(options_.threads, some.size(), [&](std::size_t k) {
      Tell(fmt::format("{}: {} of {}", how, ++begun, some.size()));
      return fit(some[k]);
    });
  }

  void SearchAll() {
    Search();
    Prune();
    RetryFromBetterMinima();
  }

  void Search() {
    levels_.assign(1, {out_.base});
    ids_.clear();
    out_.final = out_.base;
    out_.final_left = out_.base_left;
    for (const Effect& effect : StateEffectsOf(machine_))
      if (!Contains(machine_.added_effects, effect.id)) ids_.push_back(effect.id);
    for (int size = 1; size <= options_.max_effects && static_cast<std::size_t>(size) <= ids_.size();
         ++size) {
      if (size > 1 && !out_.final_left.structured) break;
      if (!OneMore(Contenders(size == 1), size == 1)) break;
    }
  }

  /// Sets with one effect more than the best ones so far, best by what is foreseen first.
  std::vector<StateContender> Contenders(bool single) {
    struct Extended {
      const StateCandidate& near;
      std::vector<std::string> added;
    };
    std::vector<Extended> extended;
    std::set<std::vector<std::string>> tried;
    const std::vector<StateCandidate>& before = levels_.back();
    for (std::size_t b = 0; b < before.size() && static_cast<int>(b) < options_.beam; ++b)
      for (const std::string& id : ids_) {
        std::vector<std::string> added = before[b].added;
        if (Contains(added, id)) continue;
        added.push_back(id);
        std::vector<std::string> sorted = added;
        std::sort(sorted.begin(), sorted.end());
        if (tried.insert(sorted).second) extended.push_back({before[b], std::move(added)});
      }
    auto screened = Each("effects by linearisation", extended,
                         [this](const Extended& e) { return fits_->Screened(e.added, e.near); });
    std::vector<StateContender> contenders;
    for (std::size_t k = 0; k < screened.size(); ++k)
      if (screened[k])
        contenders.push_back(std::move(*screened[k]));
      else if (single)
        out_.warnings.push_back(CannotBeTried(extended[k].added.back(), ToldOf(screened[k].error())));
    std::stable_sort(contenders.begin(), contenders.end(),
                     [](const auto& a, const auto& b) { return a.foreseen < b.foreseen; });
    return contenders;
  }

  /// Gain that must be foreseen of a set before it is fitted.
  double WorthAFit(const std::vector<StateContender>& contenders) const {
    if (!out_.final_left.structured)
      return std::min(options_.worth_a_fit * options_.min_gain * EvidenceOf(out_.final),
                      options_.min_removed * out_.final.held_out);
    double best = 0;
    for (const StateContender& c : contenders)
      if (c.foreseen > 0) best = std::max(best, out_.final.held_out - c.foreseen);
    return options_.contender_share * best;
  }

  /// Fits what is worth it: first what linearisation promises something of, then (LooksOn) all
  /// contenders, from short segments too, since the fit without an effect may stand in a wrong minimum. False if none does
  /// better than what was found with fewer effects.
  bool OneMore(const std::vector<StateContender>& all, bool single) {
    const std::span<const StateContender> contenders(
        all.data(), std::min(all.size(), static_cast<std::size_t>(options_.contenders)));
    const double worth = WorthAFit(all);
    const auto promises = [&](const StateContender& c) { return out_.final.held_out - c.foreseen >= worth; };
    std::vector<StateCandidate> sets;
    TakeAll(sets, Each("effects that promise most", Some(contenders, promises),
                       [this](const StateContender& c) { return fits_->Fitted(c); }));
    Sort(sets);
    StateRemainder left = LeftBy(sets);
    if (LooksOn(sets, left)) {
      const double best = sets.empty() ? INFINITY : sets.front().held_out;
      for (std::vector<StateCandidate>& fitted :
           Each("all effects", contenders, [&](const StateContender& c) {
             std::vector<StateCandidate> out;
             if (!promises(c)) out.push_back(fits_->Fitted(c));
             if (!single && !out_.base_left.structured) return out;
             const std::vector<StateCandidate>& tried = promises(c) ? sets : out;
             const auto known = std::ranges::find(tried, c.added, &StateCandidate::added);
             const bool ended = known != tried.end() && known->fitted();
             out.push_back(fits_->FittedFromSegments(c, ended ? &*known : nullptr));
             return out;
           }))
        TakeAll(sets, std::move(fitted));
      Sort(sets);
      if (!sets.empty() && sets.front().held_out != best) left = LeftBy(sets);
    }
    if (single && out_.final_left.structured && !Better(sets) && TakeAllFromAfar(sets)) left = LeftBy(sets);
    if (Better(sets) && (left.structured || compare_.Coloured(sets.front())) && LookAfar(sets))
      left = LeftBy(sets);
    if (Better(sets) && TakeNearLaws(all, sets)) left = LeftBy(sets);
    if (Better(sets) && TakeRivalsFromAfar(sets)) left = LeftBy(sets);
    if (single) TakeRanking(all, sets);
    if (!Better(sets)) return false;
    out_.final = sets.front();
    out_.final_left = std::move(left);
    levels_.push_back(std::move(sets));
    return true;
  }

  void TakeRanking(const std::vector<StateContender>& contenders, const std::vector<StateCandidate>& sets) {
    out_.ranking = sets;
    for (const StateContender& c : contenders)
      if (c.seen != EffectSeen::kYes) out_.not_seen[c.added.front()] = c.seen;
    for (const StateContender& c : contenders)
      if (std::none_of(sets.begin(), sets.end(), [&](const auto& set) { return set.added == c.added; }))
        out_.ranking.push_back(fits_->Foreseen(c));
    std::stable_sort(out_.ranking.begin() + static_cast<std::ptrdiff_t>(sets.size()), out_.ranking.end(),
                     [](const auto& a, const auto& b) { return a.held_out < b.held_out; });
  }

  void TakeAll(std::vector<StateCandidate>& sets, std::vector<StateCandidate> fitted) {
    for (StateCandidate& candidate : fitted) Take(sets, std::move(candidate));
  }

  /// Into the list, in place of a worse fit of the same set.
  void Take(std::vector<StateCandidate>& sets, StateCandidate candidate) {
    const auto same = std::find_if(sets.begin(), sets.end(), [&](const StateCandidate& other) {
      return std::is_permutation(other.added.begin(), other.added.end(), candidate.added.begin(),
                                 candidate.added.end());
    });
    if (!candidate.fitted()) {
      if (same == sets.end() && candidate.added.size() == 1 && !candidate.fit.failed.empty())
        out_.warnings.push_back(CannotBeTried(candidate.added.front(), candidate.fit.failed));
    } else if (same == sets.end()) {
      sets.push_back(std::move(candidate));
    } else if (candidate.held_out < same->held_out) {
      *same = std::move(candidate);
    }
  }

  /// Best first.
  void Sort(std::vector<StateCandidate>& sets) const {
    std::sort(sets.begin(), sets.end(), [](const auto& a, const auto& b) { return a.held_out < b.held_out; });
    if (!sets.empty()) PreferFewParameters(sets);
  }

  /// What the best set leaves may be that of a wrong minimum, which a further effect would seem to mend: it is fitted from starts
  /// all over the ranges. Whether there was a better one.
  bool LookAfar(std::vector<StateCandidate>& sets) const {
    StateCandidate afar = fits_->FittedFromAfar(sets.front());
    if (!afar.fitted() || afar.held_out >= (1 - options_.fit.same_minimum) * sets.front().held_out)
      return false;
    sets.front() = std::move(afar);
    return true;
  }

  template <class Some>
  std::vector<StateCandidate> FittedFromAfar(const Some& some) const {
    return Each("effects from starts all over the ranges", some,
                [this](const StateCandidate& set) { return fits_->FittedFromAfar(set); });
  }

  /// Where no effect helps, the model as it is may stand in a minimum from whose neighbourhood no law is found: all that were tried
  /// are fitted from starts all over the ranges. Whether one does better then.
  bool TakeAllFromAfar(std::vector<StateCandidate>& sets) {
    TakeAll(sets, FittedFromAfar(sets));
    Sort(sets);
    return Better(sets);
  }

  /// Other sets that may be the law of the best one, or imitate it, are fitted from where they come nearest to it: not to be
  /// beaten by it for having begun far off. Whether another is the best now.
  bool TakeNearLaws(const std::vector<StateContender>& contenders, std::vector<StateCandidate>& sets) {
    const StateCandidate best = sets.front();
    const auto others = [&](const StateContender& c) { return c.added != best.added; };
    TakeAll(sets, Each("effects near the law found", Some(contenders, others), [&](const StateContender& c) {
              return fits_->FittedNear(c, best, options_.near_law);
            }));
    Sort(sets);
    return sets.front().added != best.added;
  }

  /// Other sets that do much of what the best one does may stand in wrong minima: they are fitted from starts all over the ranges,
  /// not to be beaten for that. Whether another is the best now.
  bool TakeRivalsFromAfar(std::vector<StateCandidate>& sets) {
    const StateCandidate best = sets.front();
    const double removed = out_.final.held_out - best.held_out;
    const auto rivals = [&](const StateCandidate& set) {
      return set.added != best.added &&
             out_.final.held_out - set.held_out >= options_.rival_removed * removed &&
             set.held_out > (1 + options_.fit.same_minimum) * best.held_out;
    };
    std::vector<StateCandidate> afar = FittedFromAfar(Some(sets, rivals));
    std::erase_if(afar, [](const StateCandidate& candidate) { return !candidate.fitted(); });
    TakeAll(sets, std::move(afar));
    Sort(sets);
    return sets.front().added != best.added;
  }

  /// What the best set leaves, if it does better than what was found before.
  StateRemainder LeftBy(const std::vector<StateCandidate>& sets) const {
    return Better(sets) ? Left(sets.front().fit) : StateRemainder{};
  }

  /// Whether the best set needs no further look at the others.
  bool Settled(const std::vector<StateCandidate>& sets, const StateRemainder& left) const {
    return Better(sets) && out_.Unexplained(sets.front(), left) <= compare_.LeftShare(sets.front());
  }

  /// Whether sets of which linearisation promises little are fitted too: what is left is structured, or it is no white noise and
  /// none did better. About a wrong minimum linearisation says nothing of what another fit would explain.
  bool LooksOn(const std::vector<StateCandidate>& sets, const StateRemainder& left) const {
    if (out_.final_left.structured) return !Settled(sets, left);
    return compare_.Coloured(out_.final) && !Better(sets);
  }

  /// Whether the best of some does better than what was found before.
  bool Better(const std::vector<StateCandidate>& sets) const {
    return !sets.empty() && compare_.Better(out_.final, out_.final_left, sets.front());
  }

  /// The fit of fewer effects may have ended in a wrong minimum, from where another effect seemed to help: each is taken out
  /// again, the fit beginning where it ended with it, and stays out if it does not do better than what is left. What ends where
  /// the search had been says nothing new.
  void Prune() {
    for (bool smaller = true; smaller && !out_.final.added.empty();) {
      smaller = false;
      for (const std::string& id : std::vector<std::string>(out_.final.added)) {
        const StateCandidate& without = found_.Without(id);
        if (!without.fitted()) continue;
        const StateCandidate& before = levels_[levels_.size() - 2].front();
        if (without.added == before.added &&
            without.held_out >= (1 - options_.fit.same_minimum) * before.held_out)
          continue;
        StateRemainder left = Left(without.fit);
        if (compare_.Better(without, left, out_.final)) continue;
        out_.final_left = std::move(left);
        levels_.pop_back();
        std::vector<StateCandidate>& level = levels_.back();
        std::erase_if(level, [&](const StateCandidate& other) { return other.added == without.added; });
        level.insert(level.begin(), without);
        out_.final = without;
        found_.without.clear();
        smaller = true;
        break;
      }
    }
    if (!out_.final.added.empty()) return;
    out_.base = out_.final;
    out_.base_left = out_.final_left;
  }

  /// A set found may show that what it was found beyond stands in a wrong minimum: the better one takes that place, and the other
  /// sets of the size found are fitted from there too, not to be beaten for having begun elsewhere.
  void RetryFromBetterMinima() {
    if (out_.final.added.empty()) return;
    bool another = false;
    std::vector<StateCandidate>& level = levels_.back();
    StateCandidate& before = levels_[levels_.size() - 2].front();
    for (const std::string& id : std::vector<std::string>(out_.final.added)) {
      const StateCandidate without = found_.Without(id);
      const double known = without.added == before.added ? before.held_out : out_.base.held_out;
      if (!without.fitted() || without.held_out >= (1 - options_.fit.same_minimum) * known) continue;
      std::vector<std::vector<std::string>> extended;
      for (const std::string& other : ids_) {
        if (other == id || Contains(without.added, other)) continue;
        extended.push_back(without.added);
        extended.back().push_back(other);
      }
      another = another || !extended.empty();
      TakeAll(level,
              Each("effects from a better minimum", extended, [&](const std::vector<std::string>& added) {
                const auto contender = fits_->Screened(added, without);
                return contender ? fits_->Fitted(*contender) : StateCandidate{};
              }));
      if (without.added != before.added) continue;
      before = without;
      if (!before.added.empty()) continue;
      out_.base = before;
      out_.base_left = Left(out_.base.fit);
    }
    if (!another) return;
    Sort(level);
    if (level.front().added == out_.final.added) return;
    out_.final = level.front();
    out_.final_left = Left(out_.final.fit);
    found_.without.clear();
  }

  /// Where nothing is found the model as it is may stand in a wrong minimum, out of which an effect led that is not worth its name:
  /// it is fitted from where each that leaves clearly less ended. Whether it leaves clearly less itself then, and effects are to be
  /// looked for anew.
  bool TakeBaseFromEffects() {
    if (!out_.final.added.empty()) return false;
    const double clearly = (1 - options_.fit.same_minimum) * out_.base.held_out;
    const auto leaves_less = [&](const StateCandidate& c) { return c.fitted() && c.held_out < clearly; };
    std::vector<StateCandidate> bases =
        Each("the model as it is from where effects led", Some(out_.ranking, leaves_less),
             [this](const StateCandidate& c) { return fits_->Without(c, {}); });
    std::erase_if(bases, std::not_fn(leaves_less));
    if (bases.empty()) return false;
    out_.base = *std::ranges::min_element(bases, {}, &StateCandidate::held_out);
    out_.base_left = Left(out_.base.fit);
    out_.warnings.clear();
    out_.not_seen.clear();
    found_.without.clear();
    return true;
  }

  /// Of sets that do hardly worse than the best, the one with the fewest parameters that is the same law stands for both.
  void PreferFewParameters(std::vector<StateCandidate>& sets) const {
    for (std::size_t k = 1; k < sets.size(); ++k)
      if (sets[k].fit.parameters.size() < sets.front().fit.parameters.size() &&
          compare_.NearlyAsGood(sets[k], sets.front(), out_.base.held_out - sets.front().held_out) &&
          SameLaw(out_.base.fit, sets[k], sets.front(), episodes_, options_.same_law)) {
        std::rotate(sets.begin(), sets.begin() + static_cast<std::ptrdiff_t>(k),
                    sets.begin() + static_cast<std::ptrdiff_t>(k) + 1);
        return;
      }
  }

  FoundSets& found_;
  const Machine& machine_ = found_.machine;
  const std::span<const Episode> episodes_ = found_.episodes;
  const ExplainStatesOptions& options_ = found_.options;
  const SetComparison& compare_ = found_.compare;
  std::optional<CandidateFits>& fits_ = found_.fits;
  std::vector<std::vector<StateCandidate>>& levels_ = found_.levels;
  std::vector<std::string> ids_;  ///< effects that may be added
  StatesExplanation& out_ = found_.out;
};

}  // namespace

StatesExplanation SearchEffects(const Machine& machine, std::span<const Episode> episodes,
                                std::size_t start_episodes, const ExplainStatesOptions& options) {
  FoundSets found(machine, episodes, start_episodes, options);
  if (EffectSearch(found).Run()) ConcludeSearch(found);
  return std::move(found.out);
}

}  // namespace hydroscope
