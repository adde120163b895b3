#include "diagnosis/states/explain_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "diagnosis/states/added_effect.h"
#include "models/state_effects.h"

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

double Sum(const std::vector<double>& energies) {
  return std::accumulate(energies.begin(), energies.end(), 0.0);
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
    Prune();
    Conclude();
    return std::move(out_);
  }

 private:
  StateRemainder Left(const StateFit& fit) const { return RemainderOf(fit, episodes_, options_.remainder); }
  /// Energies left out, over the base's noise whatever the fit's own.
  std::vector<double> Energies(const StateFit& fit) const { return fit.HeldOutEnergies(); }

  static Eigen::VectorXd FileStart(const StateModel& model) {
    Eigen::VectorXd start(model.parameter_count());
    for (int p = 0; p < start.size(); ++p)
      start[p] = model.parameters[static_cast<std::size_t>(p)].spec.start;
    return start;
  }

  std::vector<std::string> WithAdded(const std::vector<std::string>& added) const {
    std::vector<std::string> effects = machine_.added_effects;
    effects.insert(effects.end(), added.begin(), added.end());
    return effects;
  }

  /// What a fit found, for a model with fewer effects.
  StateStart StartFrom(const StateFit& fit, const std::vector<std::string>& added) const {
    StateStart start{Eigen::VectorXd(fit.parameters.size()), fit.initial};
    Eigen::Index count = 0;
    const std::vector<std::string> effects = WithAdded(added);
    for (Eigen::Index p = 0; p < fit.parameters.size(); ++p) {
      const std::string& effect = fit.model->parameters[static_cast<std::size_t>(p)].effect;
      if (effect.empty() || std::find(effects.begin(), effects.end(), effect) != effects.end())
        start.parameters[count++] = fit.parameters[p];
    }
    start.parameters.conservativeResize(count);
    return start;
  }

  /// Where the fit of a model with further effects may begin: at the values of the nearest model, and at what short segments
  /// give, since that may stand in a wrong minimum for want of the effect.
  std::vector<StateStart> StartsOf(const std::shared_ptr<const StateModel>& model,
                                   const StateFit& near) const {
    std::vector<StateStart> starts = EffectStarts(near, model, episodes_, options_.effect_starts);
    if (!out_.base_left.structured) return starts;
    for (const Eigen::VectorXd& from : {starts.front().parameters, FileStart(*model)})
      if (auto shot = ShootStart(model, episodes_, from, options_.fit)) starts.push_back(std::move(*shot));
    return starts;
  }

  /// Fits a set from starts; from those near a fit without it if there are none.
  StateCandidate Fit(const std::vector<std::string>& added, std::vector<StateStart> starts,
                     const StateFit* near = nullptr) {
    StateCandidate candidate;
    candidate.added = added;
    const auto model = BuildStateModel(machine_, WithAdded(added));
    if (!model) {
      candidate.fit.failed = model.error().text;
      return candidate;
    }
    if (near != nullptr) starts = StartsOf(*model, *near);
    StateFitOptions quick = options_.fit;
    quick.iterations = options_.candidate_iterations;
    quick.tolerance = options_.candidate_tolerance;
    quick.start_iterations = options_.screen_iterations;
    quick.start_tolerance = options_.screen_tolerance;
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
    for (const Effect& effect : StateEffectsOf(machine_))
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
          StateCandidate candidate = Fit(added, {}, &before[b].fit);
          if (candidate.fit.solved())
            sets.push_back(std::move(candidate));
          else if (size == 1)
            out_.warnings.push_back(fmt::format("{} cannot be tried: {}", id, candidate.fit.failed));
        }
      std::sort(sets.begin(), sets.end(),
                [](const auto& a, const auto& b) { return a.held_out < b.held_out; });
      if (!sets.empty()) PreferFewParameters(sets);
      if (size == 1) out_.ranking = sets;
      if (sets.empty() || !Better(out_.final, out_.final_left, sets.front())) break;
      out_.final = sets.front();
      out_.final_left = Left(out_.final.fit);
      levels_.push_back(std::move(sets));
    }
  }

  /// Whether a set does better than another, of which `left` is left.
  bool Better(const StateCandidate& now, const StateRemainder& left, const StateCandidate& next) const {
    const auto [removed, t] = PairedGain(Energies(now.fit), Energies(next.fit));
    // An effect that acts in a few pieces has a small t however large its gain is against correlated noise.
    const bool large = removed > options_.min_gain * EvidenceOf(next) && t > options_.few_t &&
                       removed > options_.min_removed * now.held_out;
    if (!left.structured)
      return large || (removed > options_.min_gain * EvidenceOf(next) && t > options_.sure_t);
    const double predictable = now.held_out * left.share;
    return removed > options_.min_removed * predictable && removed > options_.rival_gain * EvidenceOf(next) &&
           (large || t > options_.min_t);
  }

  /// The fit of fewer effects may have ended in a wrong minimum, from where another effect seemed to help: each is taken out
  /// again, the fit beginning where it ended with it, and stays out if it does not do better than what is left.
  void Prune() {
    for (bool smaller = true; smaller && !out_.final.added.empty();) {
      smaller = false;
      for (const std::string& id : out_.final.added) {
        std::vector<std::string> rest = out_.final.added;
        rest.erase(std::find(rest.begin(), rest.end(), id));
        StateCandidate without = Fit(rest, {StartFrom(out_.final.fit, rest)});
        if (!without.fit.solved()) continue;
        StateRemainder left = Left(without.fit);
        if (Better(without, left, out_.final)) continue;
        out_.final_left = std::move(left);
        levels_.pop_back();
        std::vector<StateCandidate>& level = levels_.back();
        std::erase_if(level, [&](const StateCandidate& other) { return other.added == rest; });
        level.insert(level.begin(), without);
        out_.final = std::move(without);
        smaller = true;
        break;
      }
    }
    if (!out_.final.added.empty()) return;
    out_.base = out_.final;
    out_.base_left = out_.final_left;
  }

  /// Terms that a candidate adds to each equation along its own run, over the size of the equation's rate there.
  Eigen::MatrixXd TermsOf(const StateCandidate& candidate) const {
    const StateModel &near = *out_.base.fit.model, &with = *candidate.fit.model;
    AddedEffect effect(near, with, candidate.fit.parameters.head(near.parameter_count()));
    effect.AddDraw(candidate.fit.parameters);
    const auto equations = static_cast<Eigen::Index>(with.states() + with.output.rows);
    std::vector<Eigen::VectorXd> rows;
    Eigen::VectorXd size = Eigen::VectorXd::Zero(equations), before;
    std::vector<double> values(effect.equations().size()), input(static_cast<std::size_t>(with.driving()));
    for (std::size_t e = 0; e < episodes_.size(); ++e)
      for (int row = 0; row + 1 < episodes_[e].rows(); ++row) {
        for (std::size_t i = 0; i < with.inputs.size(); ++i)
          input[i] = episodes_[e].signal(row, with.inputs[i]);
        const StateRun& run = candidate.fit.runs[e];
        const Eigen::VectorXd state = run.states.row(row).transpose();
        effect.Values(state.data(), input.data(), values.data());
        Eigen::VectorXd terms = Eigen::VectorXd::Zero(equations);
        for (std::size_t k = 0; k < values.size(); ++k) terms[effect.equations()[k]] = values[k];
        rows.push_back(std::move(terms));
        const double period = episodes_[e].time[static_cast<std::size_t>(row) + 1] -
                              episodes_[e].time[static_cast<std::size_t>(row)];
        size.head(with.states()) +=
            ((run.states.row(row + 1) - run.states.row(row)) / period).cwiseAbs2().transpose();
        size.tail(with.output.rows) += candidate.fit.scale.cwiseAbs2();
      }
    Eigen::MatrixXd out(static_cast<Eigen::Index>(rows.size()), equations);
    for (std::size_t r = 0; r < rows.size(); ++r)
      out.row(static_cast<Eigen::Index>(r)) =
          rows[r].cwiseQuotient(size.cwiseMax(1e-300).cwiseSqrt()).transpose();
    return out;
  }

  /// Two effects of which the fitted terms are the same function in these episodes are one law.
  bool SameLaw(const StateCandidate& a, const StateCandidate& b) const {
    // What a delayed input is at a row is not at hand here.
    if (a.fit.model->delays.size() != out_.base.fit.model->delays.size() ||
        a.fit.model->delays.size() != b.fit.model->delays.size() || !a.fit.model->delays.empty())
      return false;
    const Eigen::MatrixXd of_a = TermsOf(a), of_b = TermsOf(b);
    return (of_a - of_b).norm() <= options_.same_law * of_a.norm();
  }

  /// Of sets that do hardly worse than the best, the one with the fewest parameters that is the same law stands for both.
  void PreferFewParameters(std::vector<StateCandidate>& sets) const {
    for (std::size_t k = 1; k < sets.size(); ++k)
      if (sets[k].fit.parameters.size() < sets.front().fit.parameters.size() &&
          NearlyAsGood(sets[k], sets.front()) && SameLaw(sets[k], sets.front())) {
        std::rotate(sets.begin(), sets.begin() + static_cast<std::ptrdiff_t>(k),
                    sets.begin() + static_cast<std::ptrdiff_t>(k) + 1);
        return;
      }
  }

  /// Whether energies are hardly worse than the best, which removed `removed`; `noise` is one piece of evidence.
  bool HardlyWorse(const std::vector<double>& other, const std::vector<double>& best, double removed,
                   double noise) const {
    const auto [worse, t] = PairedGain(other, best);
    const bool near = worse < options_.rival_gain * noise || t < options_.rival_t;
    return near && worse < std::max(options_.rival_gain * noise, options_.rival_share * removed);
  }

  bool NearlyAsGood(const StateCandidate& other, const StateCandidate& best) const {
    return HardlyWorse(Energies(other.fit), Energies(best.fit), out_.base.held_out - best.held_out,
                       EvidenceOf(best));
  }

  /// Whether an effect of the set found is weak, and a function that is no effect of the machine file does as well in its
  /// place: that function.
  std::optional<LikeFunction> FunctionFor(const std::string& id) {
    std::vector<std::string> rest = out_.final.added;
    rest.erase(std::find(rest.begin(), rest.end(), id));
    const StateCandidate without = rest.empty() ? out_.base : Fit(rest, {StartFrom(out_.final.fit, rest)});
    if (!without.fit.solved()) return {};
    const Specificity specificity(without.fit, out_.final.fit, episodes_, options_.specificity);
    const double noise = EvidenceOf(out_.final);
    const Specificity::Function* best = nullptr;
    for (const Specificity::Function& function : specificity.functions())
      if (best == nullptr || Sum(function.energies) < Sum(best->energies)) best = &function;
    if (best == nullptr || !HardlyWorse(best->energies, specificity.with_effect(),
                                        without.held_out - Sum(specificity.with_effect()), noise))
      return {};
    return best->named;
  }

  /// Takes from the set found what is too weak to be told from laws that nobody has named.
  void LeaveOutUnspecific() {
    std::vector<std::string> named;
    for (const std::string& id : out_.final.added) {
      const std::optional<LikeFunction> like = FunctionFor(id);
      if (!like) {
        named.push_back(id);
        continue;
      }
      out_.nearest.push_back(id);
      out_.warnings.push_back(fmt::format(
          "{} would explain a part of the error that is smaller than its noise; a function of {} in the equation of {} "
          "that is no effect of the machine file explains as much. To tell them apart, excite the machine more strongly "
          "or record for longer",
          id, like->about, like->equation));
    }
    out_.set = std::move(named);
  }

  /// Rivals of the set found: of the same size, and hardly worse.
  std::vector<StateCandidate> Rivals() const {
    std::vector<StateCandidate> rivals;
    if (levels_.size() < 2) return rivals;
    const StateCandidate& best = out_.final;
    for (const StateCandidate& other : levels_.back())
      if (other.added != best.added && NearlyAsGood(other, best) &&
          !(other.fit.parameters.size() > best.fit.parameters.size() && SameLaw(best, other)))
        rivals.push_back(other);
    return rivals;
  }

  /// Whether nothing that functions can predict is left, or next to nothing of what they could before. `unexplained` is told.
  bool Complete() {
    const double predictable = out_.base.held_out * out_.base_left.share,
                 left = out_.final.held_out * out_.final_left.share;
    out_.unexplained = out_.final_left.structured
                           ? left / std::max({predictable, out_.base.held_out - out_.final.held_out, 1e-300})
                           : 0;
    const auto effects = static_cast<double>(out_.final.added.size());
    return out_.unexplained <= options_.left_share / (effects * effects);
  }

  void Conclude() {
    const auto readings = [](const StateCandidate& c) { return std::max(1, c.fit.readings()); };
    out_.steps.emplace_back("", std::sqrt(out_.base.held_out / readings(out_.base)));
    for (std::size_t k = 1; k < levels_.size(); ++k)
      out_.steps.emplace_back(levels_[k].front().added.back(),
                              std::sqrt(levels_[k].front().held_out / readings(levels_[k].front())));
    if (out_.final.added.empty()) {
      out_.verdict = out_.base_left.structured ? Verdict::kUnknown : Verdict::kAdequate;
      return;
    }
    if (!Complete()) {
      const std::vector<std::string> nearest = out_.final.added;
      // Several effects imitate more than one does: what is not explained by all of them may be by the first.
      StateCandidate all = out_.final;
      StateRemainder left_by_all = out_.final_left;
      while (levels_.size() > 2 && !Complete()) {
        levels_.pop_back();
        out_.final = levels_.back().front();
        out_.final_left = Left(out_.final.fit);
      }
      if (!Complete()) {
        out_.final = std::move(all);
        out_.final_left = std::move(left_by_all);
        Complete();
        out_.verdict = Verdict::kUnknown;
        out_.partial = true;
        out_.nearest = nearest;
        return;
      }
    }
    out_.partial = out_.final_left.structured;
    if (out_.partial)
      out_.warnings.push_back(fmt::format(
          "functions of states and inputs still predict {:.0f} % of the error, most of it in the equation of {}: "
          "{:.2g} % of what they could predict before; a small law more is missing, or one of "
          "these differs a little",
          100 * out_.final_left.share, out_.final_left.about, 100 * out_.unexplained));
    LeaveOutUnspecific();
    if (out_.set.empty()) {
      out_.verdict = Verdict::kUnknown;
      out_.partial = true;
      return;
    }
    for (const std::string& id : out_.set) out_.groups.push_back({id});
    out_.verdict = Verdict::kNamed;
    for (const StateCandidate& rival : Rivals()) {
      for (const std::string& id : rival.added) {
        if (std::find(out_.set.begin(), out_.set.end(), id) != out_.set.end()) continue;
        const auto group = std::find_if(out_.groups.begin(), out_.groups.end(), [&](const auto& g) {
          return std::find(rival.added.begin(), rival.added.end(), g.front()) == rival.added.end();
        });
        if (group == out_.groups.end()) continue;
        out_.set.push_back(id);
        group->push_back(id);
        out_.verdict = Verdict::kAmbiguous;
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

/// Whether an equation or effect reads what an input was before, which a piece of an episode does not know.
bool ReadsThePast(const Machine& machine) {
  const auto delays = [&](const std::vector<std::string>& effects) {
    const auto model = BuildStateModel(machine, effects);
    return model && !(*model)->delays.empty();
  };
  const std::vector<Effect> effects = StateEffectsOf(machine);
  return delays(machine.added_effects) ||
         std::any_of(effects.begin(), effects.end(),
                     [&](const Effect& effect) { return delays({effect.id}); });
}

/// Pieces spread over episodes that are too long to try everything on all of their rows; empty: they are not.
std::vector<Episode> SpreadPieces(std::span<const Episode> episodes, const ExplainStatesOptions& options) {
  std::int64_t rows = 0;
  for (const Episode& episode : episodes) rows += episode.rows();
  std::vector<Episode> pieces;
  if (rows <= options.most_rows) return pieces;
  const auto step = static_cast<std::int64_t>(
      std::ceil(static_cast<double>(rows) * options.piece_rows / options.most_rows));
  for (const Episode& episode : episodes)
    for (std::int64_t first = 0; first < episode.rows(); first += step) {
      const std::int64_t count = std::min<std::int64_t>(options.piece_rows, episode.rows() - first);
      if (count < options.piece_rows && first > 0) break;
      pieces.push_back({episode.log,
                        episode.first_row + first,
                        {episode.time.begin() + first, episode.time.begin() + first + count},
                        episode.signal.middleRows(first, count)});
    }
  return pieces;
}

/// The model as it is and that with the set found, fitted on from `out` to all episodes.
void FitToAll(std::span<const Episode> episodes, const ExplainStatesOptions& options,
              StatesExplanation& out) {
  const double before = out.base.held_out;
  const Eigen::VectorXd noise = out.base.fit.noise;
  const auto fit = [&](StateCandidate& candidate, StateRemainder& left) {
    const StateStart start{candidate.fit.parameters, {}};
    StateFit all = RefitStates(candidate.fit.model, episodes, std::span(&start, 1), noise, options.fit);
    if (!all.solved()) return;
    candidate.fit = std::move(all);
    candidate.held_out = candidate.fit.HeldOutEnergy();
    left = RemainderOf(candidate.fit, episodes, options.remainder);
  };
  fit(out.base, out.base_left);
  if (out.final.added.empty()) {
    out.final = out.base;
    out.final_left = out.base_left;
  } else {
    fit(out.final, out.final_left);
  }
  for (StateCandidate& candidate : out.ranking) candidate.held_out *= out.base.held_out / before;
}

}  // namespace

StatesExplanation ExplainStates(const Machine& machine, std::span<const Episode> episodes,
                                const ExplainStatesOptions& options) {
  const std::vector<Episode> pieces =
      ReadsThePast(machine) ? std::vector<Episode>{} : SpreadPieces(episodes, options);
  if (pieces.empty()) return StatesExplainer(machine, episodes, options).Run();
  StatesExplanation out = StatesExplainer(machine, pieces, options).Run();
  if (!out.base.fit.solved()) return out;
  FitToAll(episodes, options, out);
  out.warnings.push_back(fmt::format(
      "effects were tried on {} pieces of {} rows, spread over the log; figures are those of all rows",
      pieces.size(), options.piece_rows));
  return out;
}

}  // namespace hydroscope
