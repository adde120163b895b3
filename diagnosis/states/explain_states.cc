#include "diagnosis/states/explain_states.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/contains.h"
#include "diagnosis/states/effect_search.h"
#include "diagnosis/states/other_causes/missing_limit.h"
#include "diagnosis/states/other_causes/state_limit.h"
#include "diagnosis/states/search_conclusion.h"
#include "diagnosis/states/search_sentences.h"
#include "diagnosis/states/spread_pieces.h"
#include "diagnosis/states/state_candidate.h"
#include "estimation/states/one_step.h"

namespace hydroscope {
namespace {

/// The model as it is, that with the set found and its rivals, fitted on from `out` to all episodes.
void FitToAll(std::span<const Episode> episodes, const ExplainStatesOptions& options,
              StatesExplanation& out) {
  const double before = out.base.held_out, error_before = ErrorLeftOut(out.base.fit);
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
  for (StateCandidate& candidate : out.ranking)
    candidate.held_out = candidate.added == out.final.added ? out.final.held_out
                                                            : candidate.held_out * out.base.held_out / before;
  // What lies between the model as it is and the set found is known on some of the episodes alone.
  out.scale_of_tried = ErrorLeftOut(out.base.fit) / std::max(error_before, 1e-300);
  if (out.steps.empty()) return;
  for (auto& [added, error] : out.steps) error *= out.scale_of_tried;
  out.steps.back().second = ErrorLeftOut(out.final.fit);
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

/// Runs that episodes are cut into where whole ones do not show what effects do: noise that acts on the process itself adds up over
/// an episode until it covers them, and a free run may lose its way. Empty where a run may not begin at any row.
class NoisyRuns {
 public:
  NoisyRuns(const Machine& machine, std::span<const Episode> episodes, const ExplainStatesOptions& options)
      : machine_(machine), options_(options) {
    if (BeginsAnywhere(machine)) runs_ = ShortRuns(episodes, options.noisy.readings);
    some_ = Chosen(runs_, SpreadOver(runs_.size(), options.noisy.most));
  }

  /// Whether functions predict little of what a fit over whole episodes leaves, and the runs leave far less of it.
  bool Covered(const StateFit& whole, const StateRemainder& left) const {
    if (runs_.empty() || left.least_share >= options_.covered_share) return false;
    const StateStart start{whole.parameters, {}};
    const StateFit fit = RefitStates(whole.model, some_, std::span(&start, 1), whole.noise, options_.fit);
    return fit.solved() && (fit.noise.array() < options_.covered_error * whole.noise.array()).any();
  }

  bool empty() const { return runs_.empty(); }

  /// `why` is told as a warning.
  StatesExplanation Explain(const Wording& why) const {
    StatesExplanation out = ExplainRuns(machine_, runs_, options_.noisy, {"rows", "Zeilen"}, options_);
    out.warnings.push_back(
        Tell("{}: effects were looked for in runs of {} rows, each with initial states of its own",
             "{}: Effekte wurden in Stücken von {} Zeilen gesucht, jedes mit eigenen Anfangszuständen",
             Told(why), options_.noisy.readings));
    return out;
  }

 private:
  const Machine& machine_;
  const ExplainStatesOptions& options_;
  std::vector<Episode> runs_, some_;
};

/// What is named in short runs, fitted to whole episodes from there: where functions predict as much of what it leaves as lets no
/// noise cover it (ExplainStatesOptions::covered_share), it stands in for another law, whose place 50 rows did not show.
bool WholeEpisodesRefute(const StatesExplanation& named, std::span<const Episode> episodes,
                         const Eigen::VectorXd& noise, const ExplainStatesOptions& options) {
  const StateStart start{named.final.fit.parameters, {}};
  const StateFit whole =
      RefitStates(named.final.fit.model, episodes, std::span(&start, 1), noise, options.fit);
  if (!whole.solved()) return false;
  const StateRemainder left = RemainderOf(whole, episodes, options.remainder);
  return left.structured && left.least_share >= options.covered_share;
}

/// Nothing is named in short runs that whole episodes refute.
StatesExplanation UnlessRefuted(StatesExplanation named, const StateFit& whole,
                                std::span<const Episode> episodes, const ExplainStatesOptions& options) {
  if (named.set.empty() || !WholeEpisodesRefute(named, episodes, whole.noise, options)) return named;
  named.LeaveUnknown(named.final.added);
  named.warnings.push_back(Tell(
      "over whole episodes functions of states and inputs predict most of what {} leaves: the law that is missing is another",
      "über ganze Episoden sagen Funktionen von Zuständen und Eingängen das meiste dessen voraus, was {} übrig lässt: das "
      "Gesetz, das fehlt, ist ein anderes",
      fmt::format("{}", fmt::join(named.nearest, ", "))));
  return named;
}

/// Share of the rows in stretches of `least` and more without a reading of one output: of the output that has most of them.
double BlindShare(const StateModel& model, std::span<const Episode> episodes, int least) {
  int rows = 0, most = 0;
  for (const Episode& episode : episodes) rows += episode.rows();
  for (const int signal : model.outputs) {
    int blind = 0;
    for (const Episode& episode : episodes)
      for (int row = 0, since = 0; row <= episode.rows(); ++row) {
        if (row < episode.rows() && !std::isfinite(episode.signal(row, signal))) continue;
        if (row - since >= least) blind += row - since;
        since = row + 1;
      }
    most = std::max(most, blind);
  }
  return static_cast<double>(most) / std::max(rows, 1);
}

/// Short runs that need no effect clear nothing that they do not see: each begins anew after it.
void DoubtWhatRunsDoNotSee(const StatesExplanation& whole, std::span<const Episode> episodes,
                           const ExplainStatesOptions& options, StatesExplanation& runs) {
  if (runs.verdict != Verdict::kAdequate) return;
  const double blind = BlindShare(*whole.base.fit.model, episodes, options.blind_rows);
  if (whole.base_left.bursts) {
    runs.warnings.push_back(BurstsText(*whole.base_left.bursts));
  } else if (blind >= options.blind_share) {
    runs.warnings.push_back(Tell(
        "over whole episodes more is left, and an output has no readings in {:.0f} % of the rows, long stretches of them "
        "(a sensor that ends, say): a law that acts there, an overflow, shows after them alone, where short runs begin anew. "
        "Record where sensors do not end",
        "über ganze Episoden bleibt mehr übrig, und ein Ausgang hat in {:.0f} % der Zeilen keine Messwerte, lange Strecken "
        "davon (ein Sensor, der endet, etwa): ein Gesetz, das dort wirkt, ein Überlauf, zeigt sich nur danach, wo kurze "
        "Stücke neu beginnen. Aufzeichnen, wo Sensoren nicht enden",
        100 * blind));
  } else {
    return;
  }
  runs.base_left.doubtful = true;
  runs.LeaveUnknown({});
}

/// Where short runs leave it unknown, the user is told as well what whole episodes said.
StatesExplanation WithReasonsOf(const StatesExplanation& whole, StatesExplanation runs) {
  if (runs.verdict == Verdict::kUnknown) AddOverWhole(whole.warnings, runs.warnings);
  return runs;
}

constexpr Wording kCoveredText = {
    "noise acts on the process itself, a disturbance is not measured, a sensor lags, or a slow law is missing, which adds up "
    "over an episode",
    "Rauschen wirkt auf den Prozess selbst, eine Störung wird nicht gemessen, ein Sensor hinkt nach, oder ein langsames Gesetz "
    "fehlt, was sich über eine Episode summiert"};
constexpr Wording kAstrayText = {"a free run over whole episodes loses its way",
                                 "ein freier Lauf über ganze Episoden verliert sich"};

/// What is found over whole episodes that no free run follows, where short runs tell no more, is not named if more of what it leaves
/// than a complete explanation may is foreseen from row to row: its own run is lost as that of a right law would be.
void UnlessLost(const ExplainStatesOptions& options, StatesExplanation& out) {
  if (out.set.empty() || out.OfExplained(1 - OneStepShare(out.final.fit)) <= options.left_share) return;
  out.LeaveUnknown(out.final.added);
  out.warnings.push_back(Tell("{}: {} may stand in for another law. Drive the machine less hard",
                              "{}: {} kann für ein anderes Gesetz stehen. Die Maschine weniger stark anregen",
                              Told(kAstrayText), fmt::format("{}", fmt::join(out.nearest, ", "))));
}

/// A limit of the machine file that is in doubt (FindDoubtedLimit), unless the set found leaves clearly less than the machine
/// without that limit.
std::optional<DoubtedLimit> LimitInDoubt(const StatesExplanation& found, std::span<const Episode> episodes,
                                         const ExplainStatesOptions& options) {
  if (!found.base_left.structured && !LeavesColoured(found.base, options.white_readings)) return std::nullopt;
  const auto limit = FindDoubtedLimit(found.base.fit, episodes);
  const double error = found.final.fit.noise.cwiseQuotient(found.base.fit.noise).norm() /
                       std::sqrt(static_cast<double>(found.base.fit.noise.size()));
  return limit && options.limit_margin * error >= limit->error ? limit : std::nullopt;
}

/// Of a machine file with a limit in doubt nothing else is said.
StatesExplanation WithoutEffects(StatesExplanation found, const DoubtedLimit& limit) {
  found.final = found.base;
  found.final_left = found.base_left;
  found.dynamics.reset();
  found.drift.reset();
  found.steps.resize(1);
  found.LeaveUnknown({});
  found.warnings = {DoubtedLimitText(limit)};
  return found;
}

/// A limit that the machine file does not state where what was found leaves something (FindMissingLimit).
std::optional<MissingLimit> LimitThatIsMissing(const StatesExplanation& found,
                                               std::span<const Episode> episodes,
                                               const ExplainStatesOptions& options) {
  if (!found.final_left.structured && !LeavesColoured(found.final, options.white_readings))
    return std::nullopt;
  return FindMissingLimit(found.final.fit, episodes);
}

StatesExplanation ExplainEpisodes(const Machine& machine, std::span<const Episode> episodes,
                                  const ExplainStatesOptions& options);

/// Of the machine with a limit that its file does not state. Without it something is missing: no all-clear.
StatesExplanation ExplainWithLimit(const MissingLimit& limit, const Machine& machine,
                                   std::span<const Episode> episodes, const ExplainStatesOptions& options) {
  StatesExplanation out = ExplainEpisodes(WithLimit(machine, limit), episodes, options);
  if (out.verdict == Verdict::kAdequate) out.LeaveUnknown({});
  out.warnings.insert(out.warnings.begin(), MissingLimitText(limit, machine, true));
  return out;
}

StatesExplanation ExplainEpisodes(const Machine& machine, std::span<const Episode> episodes,
                                  const ExplainStatesOptions& options) {
  const std::vector<Episode> pieces = SpreadPieces(machine, episodes, options.most_rows, options.piece_rows);
  const std::span<const Episode> tried = pieces.empty() ? episodes : std::span<const Episode>(pieces);
  StatesExplanation out = SearchEffects(machine, tried, tried.size(), options);
  if (!out.base.fit.solved()) return out;
  if (const auto limit = LimitInDoubt(out, tried, options)) return WithoutEffects(std::move(out), *limit);
  if (const auto limit = LimitThatIsMissing(out, tried, options))
    return ExplainWithLimit(*limit, machine, episodes, options);
  const bool lost = out.base.fit.ErrorOfVariation() > options.hardly_follows &&
                    LeavesColoured(out.final, options.white_readings);
  const bool told = out.dynamics || (out.drift && out.drift->share >= options.drifts_share);
  // What is found over whole episodes that are followed stands: an effect that acts slowly shows nowhere else.
  if ((out.set.empty() || lost) && !told) {
    const NoisyRuns runs(machine, tried, options);
    if (lost && !runs.empty()) {
      StatesExplanation short_runs = runs.Explain(kAstrayText);
      if (short_runs.base.fit.solved() && !short_runs.astray &&
          (short_runs.final.fit.noise.array() < options.covered_error * out.final.fit.noise.array()).any())
        return WithReasonsOf(out, std::move(short_runs));
    } else if (runs.Covered(out.base.fit, out.base_left) ||
               (!out.final.added.empty() && runs.Covered(out.final.fit, out.final_left))) {
      StatesExplanation short_runs = UnlessRefuted(runs.Explain(kCoveredText), out.base.fit, tried, options);
      DoubtWhatRunsDoNotSee(out, tried, options, short_runs);
      return WithReasonsOf(out, std::move(short_runs));
    }
    if (lost) UnlessLost(options, out);
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

void StatesExplanation::LeaveUnknown(std::vector<std::string> helped) {
  verdict = Verdict::kUnknown;
  set.clear();
  groups.clear();
  rivals.clear();
  nearest = std::move(helped);
  partial = !nearest.empty();
}

void StatesExplanation::LeaveDoubt() {
  if (verdict == Verdict::kAdequate)
    LeaveUnknown({});
  else
    partial = partial || verdict != Verdict::kUnknown;
}

double StatesExplanation::Unexplained(const StateCandidate& by, const StateRemainder& left) const {
  if (!left.structured) return 0;
  const double predictable = base.held_out * base_left.least_share;
  return by.held_out * left.least_share / std::max({predictable, base.held_out - by.held_out, 1e-300});
}

double StatesExplanation::OfExplained(double share) const {
  return share * final.held_out / std::max(base.held_out - final.held_out, 1e-300);
}

double StatesExplanation::SlowShare() const {
  const double foreseen = 1 - OneStepShare(final.fit);
  return final_left.structured || foreseen <= 1 - kSlowError * kSlowError ? 0 : OfExplained(foreseen);
}

void StatesExplanation::AddRival(StateCandidate rival) {
  const auto holds = [](const std::vector<std::string>& ids, const std::string& id) {
    return Contains(ids, id);
  };
  for (const std::string& id : rival.added) {
    if (holds(set, id) || holds(nearest, id)) continue;  // named, or left out of what is
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& g) { return !holds(rival.added, g.front()); });
    if (group == groups.end()) continue;
    set.push_back(id);
    group->push_back(id);
    verdict = Verdict::kAmbiguous;
  }
  rivals.push_back(std::move(rival));
}

StatesExplanation ExplainStates(const Machine& machine, std::span<const Episode> episodes,
                                const ExplainStatesOptions& options) {
  const bool means = std::any_of(episodes.begin(), episodes.end(),
                                 [](const Episode& episode) { return episode.mean_rows > 1; });
  std::vector<Episode> runs = means ? ShortRuns(episodes, options.means.readings) : std::vector<Episode>();
  return runs.empty() ? ExplainEpisodes(machine, episodes, options)
                      : ExplainRuns(machine, std::move(runs), options.means, "revolutions", options);
}

}  // namespace hydroscope
