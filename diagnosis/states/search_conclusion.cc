#include "diagnosis/states/search_conclusion.h"

#include <algorithm>
#include <numeric>

#include "core/contains.h"
#include "diagnosis/states/general_laws.h"
#include "diagnosis/states/law_terms.h"
#include "diagnosis/states/other_causes/missing_dynamics.h"
#include "diagnosis/states/search_sentences.h"
#include "diagnosis/states/staircase.h"

namespace hydroscope {
namespace {

class SearchConclusion {
 public:
  explicit SearchConclusion(FoundSets& found) : found_(found) {}

  void Conclude() {
    LookAgainAtUnseen();
    Judge();
    out_.steps = StaircaseTo(out_.final, levels_);
  }

 private:
  void Judge() {
    if (out_.final.fit.ErrorOfVariation() > options_.hardly_follows && compare_.Coloured(out_.final)) {
      out_.astray = true;
      TellDrift();
      out_.LeaveUnknown(out_.final.added);
      return;
    }
    const bool complete = out_.final.added.empty() || Complete() || TakeFewer(1);
    if (complete) DropStandIns();
    TellDynamics();
    TellDrift();
    if (!complete) {
      out_.LeaveUnknown(out_.final.added);
      return;
    }
    if (out_.base_left.powerless && compare_.Coloured(out_.final)) {
      out_.warnings.push_back(MayBeMissing(out_.base_left));
      out_.LeaveUnknown(Nearest());
      return;
    }
    if (MayLackLaw()) {
      out_.warnings.push_back(MayBeMissing(out_.final_left));
      out_.LeaveUnknown(Nearest());
      return;
    }
    if (out_.final.added.empty()) {
      if (out_.base_left.structured || out_.dynamics || out_.drift)
        out_.LeaveUnknown(Nearest());
      else
        out_.verdict = Verdict::kAdequate;
      return;
    }
    const double slow = out_.dynamics ? 0 : out_.SlowShare();
    if (slow > 0) out_.warnings.push_back(MoreIsSlow(slow));
    if (slow > options_.slow_share ||
        (out_.dynamics && out_.OfExplained(*out_.dynamics) > options_.dynamics_share)) {
      out_.LeaveUnknown(out_.final.added);
      return;
    }
    if (const auto law = LawThatIsMissing()) {
      out_.warnings.push_back(MoreThanForeseen(law->law, law->removed / Removed(law->removed)));
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

  /// What was found explains, or where that is nothing the best single effect, if it is too weak to be taken by itself alone, and
  /// those that are not clearly worse: naming the best of them alone would say more than the log does.
  std::vector<std::string> Nearest() const {
    if (!out_.final.added.empty() || out_.ranking.empty()) return out_.final.added;
    const StateCandidate& best = out_.ranking.front();
    if (!best.fitted()) return {};
    const auto [removed, t] = PairedGain(out_.base.fit.HeldOutEnergies(), best.fit.HeldOutEnergies());
    const bool helps = removed > options_.min_gain * EvidenceOf(best) && t > options_.few_t &&
                       removed > options_.nearest_removed * out_.base.held_out;
    if (!helps) return {};
    std::vector<std::string> nearest = best.added;
    for (const StateCandidate& other : std::span(out_.ranking).subspan(1)) {
      if (!other.fitted()) continue;
      const double share = (out_.base.held_out - other.held_out) / removed;
      const double t = PairedGain(other.fit.HeldOutEnergies(), best.fit.HeldOutEnergies()).second;
      if (share >= 1 - options_.nearest_removed || (share >= options_.rival_removed && t < options_.rival_t))
        nearest.push_back(other.added.front());
    }
    return nearest;
  }

  /// Energy that the effects of the set found that `other` has not remove beyond those that both have.
  double RemovedBeyondShared(const StateCandidate& other) {
    double shared = out_.base.held_out;
    for (const std::string& id : out_.final.added) {
      if (Contains(other.added, id)) continue;
      const StateCandidate& without = found_.Without(id);
      if (without.fitted()) shared = std::min(shared, without.held_out);
    }
    return shared - out_.final.held_out;
  }

  /// Whether an effect of the set found is weak, and a function that is no effect of the machine file does as well in its
  /// place, or a law of general shape does better: a sentence that says so.
  std::optional<Told> LikeWhat(const std::string& id) {
    const StateCandidate& without = out_.final.added.size() == 1 ? out_.base : found_.Without(id);
    if (!without.fitted()) return {};
    const Specificity specificity(without.fit, out_.final.fit, episodes_, options_.specificity);
    if (const Specificity::Function* best = specificity.Best()) {
      const std::vector<double>& with_effect = specificity.with_effect();
      const double removed = without.held_out - std::accumulate(with_effect.begin(), with_effect.end(), 0.0);
      if (compare_.HardlyWorse(best->energies, with_effect, removed, EvidenceOf(out_.final)))
        return NotToldFrom({id, id}, best->named);
    }
    return MayHideGeneralLaw() ? BetterGeneralLaw(found_, id) : std::nullopt;
  }

  /// Functions predict something of what is left, or that lasts and covers small differences of shape.
  bool MayHideGeneralLaw() const {
    return out_.final_left.structured || (!out_.dynamics && out_.SlowShare() > 0);
  }

  /// Share of what the set found explains that it does not without one of its effects.
  double ShareOf(const std::string& id) {
    if (out_.final.added.size() == 1) return 1;
    const StateCandidate& without = found_.Without(id);
    if (!without.fitted()) return 1;
    return (without.held_out - out_.final.held_out) /
           std::max(out_.base.held_out - out_.final.held_out, 1e-300);
  }

  /// Energy that functions predict of what the set leaves, of what one of its several effects takes away beside the others.
  double LeftOf(const std::string& id) {
    if (out_.final.added.size() == 1 || !out_.final_left.structured) return 0;
    const StateCandidate& without = found_.Without(id);
    if (!without.fitted()) return 0;
    return out_.final_left.least_share * out_.final.held_out /
           std::max(without.held_out - out_.final.held_out, 1e-300);
  }

  /// The best complete set of fewer effects, but at least so many, in place of the set found: several effects imitate more than one
  /// does. If there is none all stays as it is.
  bool TakeFewer(std::size_t least) {
    for (std::size_t size = levels_.size() - 1; size-- > least;) {
      const StateCandidate& fewer = levels_[size].front();
      StateRemainder left = found_.Left(fewer.fit);
      const double unexplained = out_.Unexplained(fewer, left);
      if (unexplained > compare_.LeftShare(fewer)) continue;
      out_.final = fewer;
      out_.final_left = std::move(left);
      out_.unexplained = unexplained;
      levels_.resize(size + 1);
      found_.without.clear();
      return true;
    }
    return false;
  }

  /// Of several effects those may stand in for a law that nobody has named beside which functions predict much of what they take
  /// away. Where the best set of an effect fewer is complete as well, it is what is found.
  void DropStandIns() {
    const auto stands_in = [this](const std::string& id) { return LeftOf(id) > options_.left_share; };
    while (levels_.size() > 2) {
      const StateCandidate all = out_.final;
      const StateRemainder left_by_all = out_.final_left;
      if (std::none_of(all.added.begin(), all.added.end(), stands_in) || !TakeFewer(levels_.size() - 2))
        return;
      for (const std::string& id : all.added) {
        if (Contains(out_.final.added, id)) continue;
        out_.nearest.push_back(id);
        const double removed = out_.final.held_out - all.held_out;
        out_.warnings.push_back(
            MayStandIn(id, left_by_all.least_share * all.held_out / std::max(removed, 1e-300)));
      }
    }
  }

  /// Takes from the set found what is too weak to be told from laws that nobody has named. Where that explains much, or one such law
  /// does better than the whole set, the others may stand in for the rest of it: nothing is named.
  void LeaveOutUnspecific() {
    std::vector<std::string> named;
    bool leans = false;
    for (const std::string& id : out_.final.added) {
      const std::optional<Told> like = LikeWhat(id);
      const double left = LeftOf(id);
      if (!like && left <= options_.left_share) {
        named.push_back(id);
        continue;
      }
      leans = leans || ShareOf(id) > options_.leans_share;
      out_.nearest.push_back(id);
      out_.warnings.push_back(like ? *like : MayStandIn(id, left));
    }
    const bool some_are_left = !leans && !named.empty() && named.size() < out_.final.added.size();
    if (const auto law = some_are_left ? GeneralLawInPlaceOfAll(found_) : std::nullopt) {
      leans = true;
      out_.warnings.push_back(*law);
    }
    if (leans)
      out_.nearest = out_.final.added;
    else
      out_.set = std::move(named);
  }

  /// Whether a set of fewer parameters leaves next to nothing more than the set found, and what that has beyond it is weak, and no
  /// better than a function that is no effect of the machine file: beside a cube a small law more looks like the square of a spring
  /// that is not even.
  bool DiffersByNoLaw(const StateCandidate& simpler) {
    const StateCandidate& best = out_.final;
    if (simpler.fit.parameters.size() >= best.fit.parameters.size()) return false;
    if (simpler.held_out - best.held_out > options_.rival_share * RemovedBeyondShared(simpler)) return false;
    const Specificity specificity(simpler.fit, best.fit, episodes_, options_.specificity);
    const Specificity::Function* like = specificity.Best();
    if (like == nullptr) return false;
    const std::vector<double>& with = specificity.with_effect();
    const double removed = simpler.held_out - std::accumulate(with.begin(), with.end(), 0.0);
    if (!compare_.HardlyWorse(like->energies, with, removed, EvidenceOf(best))) return false;
    out_.warnings.push_back(NotToldFrom(InPlaceOf(best.added, simpler.added), like->named));
    return true;
  }

  /// Rivals of the set found: of the same size, and hardly worse.
  std::vector<StateCandidate> Rivals() {
    std::vector<StateCandidate> rivals;
    if (levels_.size() < 2) return rivals;
    const StateCandidate& best = out_.final;
    for (const StateCandidate& other : levels_.back())
      if (other.added != best.added &&
          ((compare_.NearlyAsGood(other, best, RemovedBeyondShared(other)) &&
            !(other.fit.parameters.size() > best.fit.parameters.size() &&
              SameLaw(out_.base.fit, best, other, episodes_, options_.same_law))) ||
           DiffersByNoLaw(other)))
        rivals.push_back(other);
    return rivals;
  }

  /// Whether nothing that functions can predict is left, or next to nothing of what they could before. `unexplained` is told.
  bool Complete() {
    out_.unexplained = out_.Unexplained(out_.final, out_.final_left);
    return out_.unexplained <= compare_.LeftShare(out_.final);
  }

  /// Energy that the set found and a law beside it, which takes away `more`, remove.
  double Removed(double more) const {
    return std::max(out_.base.held_out - out_.final.held_out + more, 1e-300);
  }

  /// A law of general shape beside the set found that takes away more than a complete set may leave.
  std::optional<LawBeside> LawThatIsMissing() {
    if (!out_.final_left.structured) return std::nullopt;
    auto law = FindLawBeside(found_);
    if (!law || law->removed <= compare_.LeftShare(out_.final) * Removed(law->removed)) return std::nullopt;
    return law;
  }

  /// A law that the log shows too seldom may be in what the final set leaves, if that is more than a complete set may leave.
  bool MayLackLaw() const {
    const bool little = !out_.final.added.empty() && out_.OfExplained(1) <= compare_.LeftShare(out_.final);
    const StateRemainder& left = out_.final_left;
    const bool may = out_.final.added.empty() ? !left.structured && left.MayHideLaw() : left.doubtful;
    return may && compare_.Coloured(out_.final) && !little;
  }

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
      if (Contains(added, unseen.first)) return true;
      added.push_back(unseen.first);
      const auto contender = found_.fits->Screened(added, out_.final);
      return contender && contender->seen == EffectSeen::kYes;
    });
  }

  FoundSets& found_;
  const std::span<const Episode> episodes_ = found_.episodes;
  const ExplainStatesOptions& options_ = found_.options;
  const SetComparison& compare_ = found_.compare;
  std::vector<std::vector<StateCandidate>>& levels_ = found_.levels;
  StatesExplanation& out_ = found_.out;
};

}  // namespace

void ConcludeSearch(FoundSets& found) { SearchConclusion(found).Conclude(); }

void AddOverWhole(std::span<const Told> of_whole, std::vector<Told>& told) {
  for (const Told& sentence : of_whole)
    if (!Contains(told, sentence))
      told.push_back(Tell("over whole episodes: {}", "über ganze Episoden: {}", sentence));
}

}  // namespace hydroscope
