#include "diagnosis/states/explain_states.h"

#include <fmt/format.h>

#include <algorithm>

#include "diagnosis/states/effect_search.h"
#include "diagnosis/states/spread_pieces.h"

namespace hydroscope {
namespace {

/// The model as it is, that with the set found and its rivals, fitted on from `out` to all episodes.
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
  for (StateCandidate& rival : out.rivals) {
    StateRemainder left_by_rival;
    fit(rival, left_by_rival);
  }
  for (StateCandidate& candidate : out.ranking) candidate.held_out *= out.base.held_out / before;
}

/// On so many of the runs, spread over the log; figures are those of all. `of_what`: readings of a run.
StatesExplanation ExplainRuns(const Machine& machine, std::vector<Episode> runs, const ShortRunOptions& run,
                              const Wording& of_what, const ExplainStatesOptions& options) {
  const std::vector<Episode> some = Chosen(runs, SpreadOver(runs.size(), run.most));
  StatesExplanation out = SearchEffects(machine, some, run.starts, options);
  if (some.size() < runs.size() && out.base.fit.solved()) {
    FitToAll(runs, options, out);
    out.warnings.push_back(
        Tell("effects were tried on {} of {} runs of {} {}, spread over the log; figures are those of all",
             "Effekte wurden an {} von {} Stücken von {} {} versucht, über die Aufzeichnung verteilt; "
             "die Zahlen sind die von allen",
             some.size(), runs.size(), run.readings, of_what));
  }
  out.runs = std::move(runs);
  return out;
}

/// Tells noise that acts on the process itself: it adds up over an episode until it covers what effects do, and no function of
/// states and inputs predicts it.
class CoveringNoise {
 public:
  CoveringNoise(const Machine& machine, std::span<const Episode> episodes,
                const ExplainStatesOptions& options)
      : options_(options) {
    if (BeginsAnywhere(machine)) runs_ = ShortRuns(episodes, options.noisy.readings);
    some_ = Chosen(runs_, SpreadOver(runs_.size(), options.noisy.most));
  }

  /// Whether functions predict little of what a fit over whole episodes leaves, and short runs leave far less of it.
  bool Covers(const StateFit& whole, const StateRemainder& left) const {
    if (runs_.empty() || left.share >= options_.covered_share) return false;
    const StateStart start{whole.parameters, {}};
    const StateFit fit = RefitStates(whole.model, some_, std::span(&start, 1), whole.noise, options_.fit);
    return fit.solved() && (fit.noise.array() < options_.covered_error * whole.noise.array()).any();
  }

  const std::vector<Episode>& runs() const { return runs_; }

 private:
  const ExplainStatesOptions& options_;
  std::vector<Episode> runs_, some_;
};

StatesExplanation ExplainNoisy(const Machine& machine, const CoveringNoise& noise,
                               const ExplainStatesOptions& options) {
  StatesExplanation out = ExplainRuns(machine, noise.runs(), options.noisy, {"rows", "Zeilen"}, options);
  out.warnings.push_back(Tell(
      "noise acts on the process itself (or a disturbance that is not measured) and adds up over an episode: effects "
      "were looked for in runs of {} rows, each with initial states of its own",
      "Rauschen wirkt auf den Prozess selbst (oder eine Störung, die nicht gemessen wird) und summiert sich über eine "
      "Episode: Effekte wurden in Stücken von {} Zeilen gesucht, jedes mit eigenen Anfangszuständen",
      options.noisy.readings));
  return out;
}

StatesExplanation ExplainEpisodes(const Machine& machine, std::span<const Episode> episodes,
                                  const ExplainStatesOptions& options) {
  const std::vector<Episode> pieces = SpreadPieces(machine, episodes, options.most_rows, options.piece_rows);
  const std::span<const Episode> tried = pieces.empty() ? episodes : std::span<const Episode>(pieces);
  StatesExplanation out = SearchEffects(machine, tried, tried.size(), options);
  if (!out.base.fit.solved()) return out;
  // What is found over whole episodes stands: an effect that acts slowly shows nowhere else.
  if (out.set.empty()) {
    const CoveringNoise noise(machine, tried, options);
    if (noise.Covers(out.base.fit, out.base_left) ||
        (!out.final.added.empty() && noise.Covers(out.final.fit, out.final_left)))
      return ExplainNoisy(machine, noise, options);
  }
  if (pieces.empty()) return out;
  FitToAll(episodes, options, out);
  out.warnings.push_back(
      Tell("effects were tried on {} pieces of {} rows, spread over the log; figures are those of all rows",
           "Effekte wurden an {} Stücken von {} Zeilen versucht, über die Aufzeichnung verteilt; "
           "die Zahlen sind die von allen Zeilen",
           pieces.size(), options.piece_rows));
  return out;
}

}  // namespace

StatesExplanation ExplainStates(const Machine& machine, std::span<const Episode> episodes,
                                const ExplainStatesOptions& options) {
  const bool means = std::any_of(episodes.begin(), episodes.end(),
                                 [](const Episode& episode) { return episode.mean_rows > 1; });
  if (!means) return ExplainEpisodes(machine, episodes, options);
  std::vector<Episode> runs = ShortRuns(episodes, options.means.readings);
  if (runs.empty()) return ExplainEpisodes(machine, episodes, options);
  return ExplainRuns(machine, std::move(runs), options.means, "revolutions", options);
}

}  // namespace hydroscope
