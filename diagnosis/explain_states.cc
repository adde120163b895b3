#include "diagnosis/explain_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace hydroscope {
namespace {

/// How much lower the second energies are: sum, and its t over the pieces.
std::pair<double, double> PairedGain(const std::vector<double>& before, const std::vector<double>& after) {
  const auto n = static_cast<double>(before.size());
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < before.size(); ++k) sum += before[k] - after[k];
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double d = before[k] - after[k] - sum / n;
    squares += d * d;
  }
  const double error = std::sqrt(squares * n / std::max(n - 1, 1.0));
  return {sum, error > 0 ? sum / error : 0.0};
}

/// Readings over which the errors of a fit are correlated: 1 + 2 sum of their autocorrelation until it first vanishes.
double CorrelatedReadings(const StateFit& fit) {
  constexpr Eigen::Index kLags = 100;
  double longest = 1;
  for (Eigen::Index j = 0; j < fit.noise.size(); ++j) {
    double sum = 1;
    for (Eigen::Index lag = 1; lag <= kLags; ++lag) {
      double product = 0, energy = 0;
      for (const RowMatrix& residual : fit.residuals)
        for (Eigen::Index row = lag; row < residual.rows(); ++row) {
          const double now = residual(row, j), then = residual(row - lag, j);
          if (!std::isfinite(now) || !std::isfinite(then)) continue;
          product += now * then;
          energy += now * now;
        }
      if (!(product > 0)) break;
      sum += 2 * product / energy;
    }
    longest = std::max(longest, sum);
  }
  return longest;
}

class StatesExplainer {
 public:
  StatesExplainer(const Machine& machine, std::span<const Episode> episodes,
                  const ExplainStatesOptions& options)
      : machine_(machine), episodes_(episodes), options_(options) {}

  StatesExplanation Run() {
    const auto model = BuildStateModel(machine_, machine_.added_effects);
    if (!model) {
      out_.base.fit.failed = model.error().text;
      return std::move(out_);
    }
    out_.base.fit = FitStates(*model, episodes_, options_.fit);
    if (!out_.base.fit.solved()) return std::move(out_);
    noise_ = out_.base.fit.noise;
    out_.base.held_out = out_.base.fit.HeldOutEnergy();
    out_.base_left = Left(out_.base.fit);
    Search();
    Conclude();
    return std::move(out_);
  }

 private:
  StateRemainder Left(const StateFit& fit) const { return RemainderOf(fit, episodes_, options_.remainder); }
  /// Energies left out, over the base's noise whatever the fit's own.
  std::vector<double> Energies(const StateFit& fit) const { return fit.HeldOutEnergies(); }

  /// Fits a set from the values of the nearest model, and from what short segments give.
  StateCandidate Fit(const std::vector<std::string>& added, const StateFit& near) {
    StateCandidate candidate;
    candidate.added = added;
    std::vector<std::string> effects = machine_.added_effects;
    effects.insert(effects.end(), added.begin(), added.end());
    const auto model = BuildStateModel(machine_, effects);
    if (!model) {
      candidate.fit.failed = model.error().text;
      return candidate;
    }
    StateFitOptions quick = options_.fit;
    quick.iterations = options_.candidate_iterations;
    quick.tolerance = options_.candidate_tolerance;
    quick.start_iterations = options_.screen_iterations;
    quick.start_tolerance = options_.screen_tolerance;
    std::vector<StateStart> starts = EffectStarts(near, *model, episodes_, options_.effect_starts);
    if (out_.base_left.structured)  // the base may stand in a wrong minimum for want of the effect
      if (auto shot = ShootStart(*model, episodes_, starts.front().parameters, options_.fit))
        starts.push_back(std::move(*shot));
    candidate.fit = RefitStates(*model, episodes_, starts, noise_, quick);
    if (candidate.fit.solved()) {
      candidate.held_out = candidate.fit.HeldOutEnergy();
      std::tie(candidate.gain, candidate.t) = PairedGain(Energies(out_.base.fit), Energies(candidate.fit));
    }
    return candidate;
  }

  /// Energy that counts as one piece of evidence: that of a reading, times the readings over which errors are correlated.
  static double EvidenceOf(const StateCandidate& candidate) {
    return candidate.held_out / std::max(1, candidate.fit.readings()) * CorrelatedReadings(candidate.fit);
  }

  void Search() {
    std::vector<std::string> ids;
    for (const UserEffectSpec& effect : machine_.user_effects)
      if (std::find(machine_.added_effects.begin(), machine_.added_effects.end(), effect.id) ==
          machine_.added_effects.end())
        ids.push_back(effect.id);
    levels_.push_back({out_.base});
    out_.final = out_.base;
    out_.final_left = out_.base_left;
    std::set<std::vector<std::string>> tried;
    for (int size = 1; size <= options_.max_effects && static_cast<std::size_t>(size) <= ids.size(); ++size) {
      if (size > 1 && !out_.final_left.structured) break;
      std::vector<StateCandidate> sets;
      const std::vector<StateCandidate>& before = levels_.back();
      for (std::size_t b = 0; b < before.size() && static_cast<int>(b) < options_.beam; ++b)
        for (const std::string& id : ids) {
          std::vector<std::string> added = before[b].added;
          if (std::find(added.begin(), added.end(), id) != added.end()) continue;
          added.push_back(id);
          std::vector<std::string> sorted = added;
          std::sort(sorted.begin(), sorted.end());
          if (!tried.insert(sorted).second) continue;
          StateCandidate candidate = Fit(added, before[b].fit);
          if (candidate.fit.solved())
            sets.push_back(std::move(candidate));
          else if (size == 1)
            out_.warnings.push_back(fmt::format("{} cannot be tried: {}", id, candidate.fit.failed));
        }
      std::sort(sets.begin(), sets.end(),
                [](const auto& a, const auto& b) { return a.held_out < b.held_out; });
      if (size == 1) out_.ranking = sets;
      if (sets.empty() || !Better(sets.front())) break;
      out_.final = sets.front();
      out_.final_left = Left(out_.final.fit);
      levels_.push_back(std::move(sets));
    }
  }

  /// Whether a set does better than what stands so far.
  bool Better(const StateCandidate& next) const {
    const StateCandidate& now = out_.final;
    const auto [removed, t] = PairedGain(Energies(now.fit), Energies(next.fit));
    // An effect that acts in a few pieces has a small t however large its gain is against correlated noise.
    const bool large = removed > options_.min_gain * EvidenceOf(next) && t > options_.few_t &&
                       removed > options_.min_removed * now.held_out;
    if (!out_.final_left.structured)
      return large || (removed > options_.min_gain * EvidenceOf(next) && t > options_.sure_t);
    const double predictable = now.held_out * out_.final_left.share;
    return removed > options_.min_removed * predictable && removed > options_.rival_gain * EvidenceOf(next) &&
           (large || t > options_.min_t);
  }

  /// Rivals of the set found: of the same size, and hardly worse.
  std::vector<StateCandidate> Rivals() const {
    std::vector<StateCandidate> rivals;
    if (levels_.size() < 2) return rivals;
    const StateCandidate& best = out_.final;
    const double noise = EvidenceOf(best), removed = out_.base.held_out - best.held_out;
    for (const StateCandidate& other : levels_.back()) {
      if (other.added == best.added) continue;
      const auto [worse, t] = PairedGain(Energies(other.fit), Energies(best.fit));
      const bool near = worse < options_.rival_gain * noise || t < options_.rival_t;
      if (near && worse < std::max(options_.rival_gain * noise, options_.rival_share * removed))
        rivals.push_back(other);
    }
    return rivals;
  }

  void Conclude() {
    const auto readings = [](const StateCandidate& c) { return std::max(1, c.fit.readings()); };
    out_.steps.emplace_back("", std::sqrt(out_.base.held_out / readings(out_.base)));
    for (std::size_t k = 1; k < levels_.size(); ++k)
      out_.steps.emplace_back(levels_[k].front().added.back(),
                              std::sqrt(levels_[k].front().held_out / readings(levels_[k].front())));
    const bool found = !out_.final.added.empty();
    const double predictable = out_.base.held_out * out_.base_left.share,
                 left = out_.final.held_out * out_.final_left.share;
    const double removed = out_.base.held_out - out_.final.held_out;
    const bool complete = !out_.final_left.structured ||
                          (found && left <= options_.left_share * std::max(predictable, removed));
    if (!found) {
      out_.verdict = out_.base_left.structured ? Verdict::kUnknown : Verdict::kAdequate;
      return;
    }
    if (!complete) {
      out_.verdict = Verdict::kUnknown;
      out_.partial = true;
      out_.nearest = out_.final.added;
      return;
    }
    out_.partial = out_.final_left.structured;
    out_.set = out_.final.added;
    for (const std::string& id : out_.set) out_.groups.push_back({id});
    out_.verdict = Verdict::kNamed;
    for (const StateCandidate& rival : Rivals()) {
      out_.verdict = Verdict::kAmbiguous;
      for (const std::string& id : rival.added) {
        if (std::find(out_.set.begin(), out_.set.end(), id) != out_.set.end()) continue;
        out_.set.push_back(id);
        for (std::size_t g = 0; g < out_.groups.size(); ++g)
          if (std::find(rival.added.begin(), rival.added.end(), out_.groups[g].front()) ==
              rival.added.end()) {
            out_.groups[g].push_back(id);
            break;
          }
      }
    }
  }

  const Machine& machine_;
  std::span<const Episode> episodes_;
  const ExplainStatesOptions& options_;
  Eigen::VectorXd noise_;
  std::vector<std::vector<StateCandidate>> levels_;  ///< per number of effects, sets best first
  StatesExplanation out_;
};

}  // namespace

StatesExplanation ExplainStates(const Machine& machine, std::span<const Episode> episodes,
                                const ExplainStatesOptions& options) {
  return StatesExplainer(machine, episodes, options).Run();
}

}  // namespace hydroscope
