#include "diagnosis/states/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/told_error.h"
#include "diagnosis/states/candidate_fits.h"
#include "diagnosis/states/law_terms.h"
#include "diagnosis/states/other_causes/missing_dynamics.h"
#include "diagnosis/states/search_sentences.h"
#include "diagnosis/states/set_comparison.h"
#include "diagnosis/states/spread_pieces.h"
#include "diagnosis/states/staircase.h"
#include "models/state_effects.h"

namespace hydroscope {
namespace {

class EffectSearch {
 public:
  EffectSearch(const Machine& machine, std::span<const Episode> episodes, std::size_t start_episodes,
               const ExplainStatesOptions& options)
      : machine_(machine),
        episodes_(episodes),
        options_(options),
        compare_(options),
        starts_on_(SpreadOver(episodes.size(), start_episodes)) {}

  StatesExplanation Run() {
    const auto model = BuildStateModel(machine_, machine_.added_effects);
    if (!model) {
      out_.base.fit.failed = ToldOf(model.error());
      return std::move(out_);
    }
    out_.base.fit = FitFromAllStarts(*model);
    if (!out_.base.fit.solved()) return std::move(out_);
    out_.base.held_out = out_.base.fit.HeldOutEnergy();
    out_.base_left = Left(out_.base.fit);
    fits_.emplace(machine_, episodes_, starts_on_, options_, out_.base);
    Search();
    Prune();
    RetryFromBetterMinima();
    Conclude();
    return std::move(out_);
  }

 private:
  StateFit FitFromAllStarts(const std::shared_ptr<const StateModel>& model) const {
    if (starts_on_.size() == episodes_.size()) return FitStates(model, episodes_, options_.fit);
    StateFit few = FitStates(model, Chosen(episodes_, starts_on_), options_.fit);
    if (!few.solved()) return few;
    const StateStart start{few.parameters, {}};
    StateFit all = RefitStates(model, episodes_, std::span(&start, 1), {}, options_.fit);
    all.minima = std::move(few.minima);
    all.starts_tried = few.starts_tried;
    all.starts_diverged = few.starts_diverged;
    return all;
  }
  StateRemainder Left(const StateFit& fit) const { return RemainderOf(fit, episodes_, options_.remainder); }

  void Search() {
    levels_.push_back({out_.base});
    out_.final = out_.base;
    out_.final_left = out_.base_left;
    for (const Effect& effect : StateEffectsOf(machine_))
      if (std::find(machine_.added_effects.begin(), machine_.added_effects.end(), effect.id) ==
          machine_.added_effects.end())
        ids_.push_back(effect.id);
    for (int size = 1; size <= options_.max_effects && static_cast<std::size_t>(size) <= ids_.size();
         ++size) {
      if (size > 1 && !out_.final_left.structured) break;
      if (!OneMore(Contenders(size == 1), size == 1)) break;
    }
  }

  /// Sets with one effect more than the best ones so far, best by what is foreseen first.
  std::vector<StateContender> Contenders(bool single) {
    std::vector<StateContender> contenders;
    std::set<std::vector<std::string>> tried;
    const std::vector<StateCandidate>& before = levels_.back();
    for (std::size_t b = 0; b < before.size() && static_cast<int>(b) < options_.beam; ++b)
      for (const std::string& id : ids_) {
        std::vector<std::string> added = before[b].added;
        if (std::find(added.begin(), added.end(), id) != added.end()) continue;
        added.push_back(id);
        std::vector<std::string> sorted = added;
        std::sort(sorted.begin(), sorted.end());
        if (!tried.insert(sorted).second) continue;
        auto contender = fits_->Screened(added, before[b]);
        if (contender)
          contenders.push_back(std::move(*contender));
        else if (single)
          out_.warnings.push_back(CannotBeTried(id, ToldOf(contender.error())));
      }
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
    std::vector<StateCandidate> sets;
    for (const StateContender& c : contenders)
      if (out_.final.held_out - c.foreseen >= worth) Take(sets, fits_->Fitted(c));
    Sort(sets);
    StateRemainder left = LeftBy(sets);
    if (LooksOn(sets, left)) {
      const double best = sets.empty() ? INFINITY : sets.front().held_out;
      for (const StateContender& c : contenders) {
        if (out_.final.held_out - c.foreseen < worth) Take(sets, fits_->Fitted(c));
        if (single || out_.base_left.structured) Take(sets, fits_->FittedFromSegments(c));
      }
      Sort(sets);
      if (!sets.empty() && sets.front().held_out != best) left = LeftBy(sets);
    }
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

  /// Other sets that may be the law of the best one, or imitate it, are fitted from where they come nearest to it: not to be
  /// beaten by it for having begun far off. Whether another is the best now.
  bool TakeNearLaws(const std::vector<StateContender>& contenders, std::vector<StateCandidate>& sets) {
    const StateCandidate best = sets.front();
    for (const StateContender& c : contenders)
      if (c.added != best.added) Take(sets, fits_->FittedNear(c, best, options_.near_law));
    Sort(sets);
    return sets.front().added != best.added;
  }

  /// Other sets that do much of what the best one does may stand in wrong minima: they are fitted from starts all over the ranges,
  /// not to be beaten for that. Whether another is the best now.
  bool TakeRivalsFromAfar(std::vector<StateCandidate>& sets) {
    const std::vector<StateCandidate> before = sets;
    const double removed = out_.final.held_out - before.front().held_out;
    for (const StateCandidate& set : before)
      if (set.added != before.front().added &&
          out_.final.held_out - set.held_out >= options_.rival_removed * removed &&
          set.held_out > (1 + options_.fit.same_minimum) * before.front().held_out)
        if (StateCandidate afar = fits_->FittedFromAfar(set); afar.fitted()) Take(sets, std::move(afar));
    Sort(sets);
    return sets.front().added != before.front().added;
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

  /// A set with an effect of the set found taken out, fitted from there.
  const StateCandidate& Without(const std::string& id) {
    std::vector<std::string> rest = out_.final.added;
    rest.erase(std::find(rest.begin(), rest.end(), id));
    const auto known = without_.find(rest);
    if (known != without_.end()) return known->second;
    StateCandidate fitted = fits_->Without(out_.final, rest);
    return without_.emplace(rest, std::move(fitted)).first->second;
  }

  /// The fit of fewer effects may have ended in a wrong minimum, from where another effect seemed to help: each is taken out
  /// again, the fit beginning where it ended with it, and stays out if it does not do better than what is left. What ends where
  /// the search had been says nothing new.
  void Prune() {
    for (bool smaller = true; smaller && !out_.final.added.empty();) {
      smaller = false;
      for (const std::string& id : std::vector<std::string>(out_.final.added)) {
        const StateCandidate& without = Without(id);
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
        without_.clear();
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
      const StateCandidate without = Without(id);
      const double known = without.added == before.added ? before.held_out : out_.base.held_out;
      if (!without.fitted() || without.held_out >= (1 - options_.fit.same_minimum) * known) continue;
      for (const std::string& other : ids_) {
        std::vector<std::string> added = without.added;
        added.push_back(other);
        if (other == id || std::find(added.begin(), added.end() - 1, other) != added.end() - 1) continue;
        if (const auto contender = fits_->Screened(added, without)) Take(level, fits_->Fitted(*contender));
        another = true;
      }
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
    without_.clear();
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

  /// Energy that the effects of the set found that `other` has not remove beyond those that both have.
  double RemovedBeyondShared(const StateCandidate& other) {
    double shared = out_.base.held_out;
    for (const std::string& id : out_.final.added) {
      if (std::find(other.added.begin(), other.added.end(), id) != other.added.end()) continue;
      const StateCandidate& without = Without(id);
      if (without.fitted()) shared = std::min(shared, without.held_out);
    }
    return shared - out_.final.held_out;
  }

  /// A law of general shape that is no effect of the machine file and does better in place of the only effect found, both fitted:
  /// where functions predict something of what is left, or where that lasts and covers small differences of shape.
  std::optional<Told> GeneralLawFor(const std::string& id) const {
    if (out_.final.added.size() > 1 ||
        (!out_.final_left.structured && (out_.dynamics || out_.SlowShare() == 0)))
      return {};
    const GeneralLaws general(machine_, id, out_.base.fit, episodes_);
    const CandidateFits fits(general.machine, episodes_, starts_on_, options_, out_.base);
    std::vector<std::pair<StateContender, const GeneralLaw*>> contenders;
    for (const GeneralLaw& law : general.laws)
      if (auto contender = fits.Screened({law.id}, out_.base))
        contenders.emplace_back(std::move(*contender), &law);
    std::ranges::stable_sort(
        contenders, [](const auto& a, const auto& b) { return a.first.foreseen < b.first.foreseen; });
    if (contenders.size() > static_cast<std::size_t>(options_.contenders))
      contenders.erase(contenders.begin() + options_.contenders, contenders.end());
    const double enough =
        out_.final.held_out *
        (1 - (out_.final_left.structured ? options_.min_removed * out_.final_left.least_share : 0));
    for (const auto& [contender, law] : contenders) {
      const StateCandidate other = fits.Fitted(contender);
      if (other.fitted() && other.held_out < enough &&
          !SameLaw(out_.base.fit, out_.final, other, episodes_, options_.same_law))
        return NotToldFromGeneral(id, *law);
    }
    return {};
  }

  /// Whether an effect of the set found is weak, and a function that is no effect of the machine file does as well in its
  /// place, or a law of general shape does better: a sentence that says so.
  std::optional<Told> FunctionFor(const std::string& id) {
    const StateCandidate& without = out_.final.added.size() == 1 ? out_.base : Without(id);
    if (!without.fitted()) return {};
    const Specificity specificity(without.fit, out_.final.fit, episodes_, options_.specificity);
    const Specificity::Function* best = specificity.Best();
    if (best == nullptr) return GeneralLawFor(id);
    const std::vector<double>& with_effect = specificity.with_effect();
    const double removed = without.held_out - std::accumulate(with_effect.begin(), with_effect.end(), 0.0);
    if (compare_.HardlyWorse(best->energies, with_effect, removed, EvidenceOf(out_.final)))
      return NotToldFrom(id, best->named);
    return GeneralLawFor(id);
  }

  /// Share of what the set found explains that it does not without one of its effects.
  double ShareOf(const std::string& id) {
    if (out_.final.added.size() == 1) return 1;
    const StateCandidate& without = Without(id);
    if (!without.fitted()) return 1;
    return (without.held_out - out_.final.held_out) /
           std::max(out_.base.held_out - out_.final.held_out, 1e-300);
  }

  /// Energy that functions predict of what the set leaves, of what one of its several effects takes away beside the others.
  double LeftOf(const std::string& id) {
    if (out_.final.added.size() == 1 || !out_.final_left.structured) return 0;
    const StateCandidate& without = Without(id);
    if (!without.fitted()) return 0;
    return out_.final_left.least_share * out_.final.held_out /
           std::max(without.held_out - out_.final.held_out, 1e-300);
  }

  /// Of several effects those may stand in for a law that nobody has named beside which functions predict much of what they take
  /// away. Where fewer effects are complete as well, these are what is found.
  void DropStandIns() {
    while (levels_.size() > 2) {
      const auto& added = out_.final.added;
      const auto weak = std::find_if(added.begin(), added.end(), [this](const std::string& id) {
        return LeftOf(id) > options_.left_share;
      });
      if (weak == added.end()) return;
      const StateCandidate all = out_.final;
      const StateRemainder left_by_all = out_.final_left;
      std::vector<StateCandidate> level = std::move(levels_.back());
      levels_.pop_back();
      out_.final = levels_.back().front();
      out_.final_left = Left(out_.final.fit);
      if (!Complete()) {
        levels_.push_back(std::move(level));
        out_.final = all;
        out_.final_left = left_by_all;
        Complete();
        return;
      }
      without_.clear();
      for (const std::string& id : all.added) {
        if (std::find(out_.final.added.begin(), out_.final.added.end(), id) != out_.final.added.end())
          continue;
        out_.nearest.push_back(id);
        const double removed = out_.final.held_out - all.held_out;
        out_.warnings.push_back(
            MayStandIn(id, left_by_all.least_share * all.held_out / std::max(removed, 1e-300)));
      }
    }
  }

  /// Takes from the set found what is too weak to be told from laws that nobody has named. Where that explains much, the others
  /// may stand in for the rest of such a law: nothing is named.
  void LeaveOutUnspecific() {
    std::vector<std::string> named;
    bool leans = false;
    for (const std::string& id : out_.final.added) {
      const std::optional<Told> like = FunctionFor(id);
      const double left = LeftOf(id);
      if (!like && left <= options_.left_share) {
        named.push_back(id);
        continue;
      }
      leans = leans || ShareOf(id) > options_.leans_share;
      out_.nearest.push_back(id);
      out_.warnings.push_back(like ? *like : MayStandIn(id, left));
    }
    if (leans)
      out_.nearest = out_.final.added;
    else
      out_.set = std::move(named);
  }

  /// Rivals of the set found: of the same size, and hardly worse.
  std::vector<StateCandidate> Rivals() {
    std::vector<StateCandidate> rivals;
    if (levels_.size() < 2) return rivals;
    const StateCandidate& best = out_.final;
    for (const StateCandidate& other : levels_.back())
      if (other.added != best.added && compare_.NearlyAsGood(other, best, RemovedBeyondShared(other)) &&
          !(other.fit.parameters.size() > best.fit.parameters.size() &&
            SameLaw(out_.base.fit, best, other, episodes_, options_.same_law)))
        rivals.push_back(other);
    return rivals;
  }

  /// Whether nothing that functions can predict is left, or next to nothing of what they could before. `unexplained` is told.
  bool Complete() {
    out_.unexplained = out_.Unexplained(out_.final, out_.final_left);
    return out_.unexplained <= compare_.LeftShare(out_.final);
  }

  /// A law that the log shows too seldom may be in what the final set leaves.
  bool MayLackLaw() const { return out_.final_left.doubtful && compare_.Coloured(out_.final); }

  void TellDrift() {
    out_.drift = FindParameterDrift(out_.final.fit, out_.final_left);
    if (out_.drift) out_.warnings.push_back(ParameterDriftText(*out_.drift));
  }
  void TellDynamics() {
    out_.dynamics = FindMissingDynamics(out_.final.fit, out_.final_left, episodes_);
    if (out_.dynamics) out_.warnings.push_back(MissingDynamicsText(*out_.dynamics));
  }

  /// What the model as it is does not show may be seen about the set found, from where a tank whose level is right reaches its brim.
  void LookAgainAtUnseen() {
    if (out_.final.added.empty()) return;
    std::erase_if(out_.not_seen, [this](const auto& unseen) {
      std::vector<std::string> added = out_.final.added;
      if (std::find(added.begin(), added.end(), unseen.first) != added.end()) return true;
      added.push_back(unseen.first);
      const auto contender = fits_->Screened(added, out_.final);
      return contender && contender->seen == EffectSeen::kYes;
    });
  }

  void Conclude() {
    LookAgainAtUnseen();
    out_.steps = StaircaseTo(out_.final, levels_);
    if (out_.final.fit.ErrorOfVariation() > options_.hardly_follows && compare_.Coloured(out_.final)) {
      out_.astray = true;
      TellDrift();
      out_.LeaveUnknown(out_.final.added);
      return;
    }
    const bool complete = out_.final.added.empty() || Complete() || CompleteWithFewer();
    if (complete) DropStandIns();
    TellDynamics();
    TellDrift();
    if (!complete) {
      out_.LeaveUnknown(out_.final.added);
      return;
    }
    if (MayLackLaw()) {
      out_.warnings.push_back(MayBeMissing(out_.final_left));
      out_.LeaveUnknown(out_.final.added);
      return;
    }
    if (out_.final.added.empty()) {
      out_.verdict =
          out_.base_left.structured || out_.dynamics || out_.drift ? Verdict::kUnknown : Verdict::kAdequate;
      return;
    }
    const double slow = out_.dynamics ? 0 : out_.SlowShare();
    if (slow > 0) out_.warnings.push_back(MoreIsSlow(slow));
    if (slow > options_.slow_share ||
        (out_.dynamics && out_.OfExplained(*out_.dynamics) > options_.dynamics_share)) {
      out_.LeaveUnknown(out_.final.added);
      return;
    }
    out_.partial = out_.final_left.structured || out_.dynamics || slow > 0;
    if (out_.final_left.structured) out_.warnings.push_back(MoreIsMissing(out_.final_left, out_.unexplained));
    LeaveOutUnspecific();
    if (out_.set.empty()) {
      out_.verdict = Verdict::kUnknown;
      out_.partial = true;
      return;
    }
    for (const std::string& id : out_.set) out_.groups.push_back({id});
    out_.verdict = Verdict::kNamed;
    for (StateCandidate& rival : Rivals()) out_.AddRival(std::move(rival));
  }

  /// Several effects imitate more than one does: what is not explained by all of them may be by the first. Whether it is; if
  /// not, all of them stay.
  bool CompleteWithFewer() {
    StateCandidate all = out_.final;
    StateRemainder left_by_all = out_.final_left;
    while (levels_.size() > 2) {
      levels_.pop_back();
      out_.final = levels_.back().front();
      out_.final_left = Left(out_.final.fit);
      if (Complete()) return true;
    }
    out_.final = std::move(all);
    out_.final_left = std::move(left_by_all);
    return Complete();
  }

  const Machine& machine_;
  std::span<const Episode> episodes_;
  const ExplainStatesOptions& options_;
  const SetComparison compare_;
  std::vector<std::size_t> starts_on_;                          ///< episodes that starts are tried on
  std::optional<CandidateFits> fits_;                           ///< once the base is fitted
  std::vector<std::vector<StateCandidate>> levels_;             ///< per number of effects, sets best first
  std::vector<std::string> ids_;                                ///< effects that may be added
  std::map<std::vector<std::string>, StateCandidate> without_;  ///< the set found without an effect
  StatesExplanation out_;
};

}  // namespace

StatesExplanation SearchEffects(const Machine& machine, std::span<const Episode> episodes,
                                std::size_t start_episodes, const ExplainStatesOptions& options) {
  return EffectSearch(machine, episodes, start_episodes, options).Run();
}

}  // namespace hydroscope
