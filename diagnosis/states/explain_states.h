#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/explain.h"
#include "diagnosis/states/other_causes/parameter_drift.h"
#include "diagnosis/states/remainder.h"
#include "diagnosis/states/screened_effect.h"
#include "diagnosis/states/specificity.h"
#include "diagnosis/states/state_candidate.h"

namespace hydroscope {

/// Short runs that episodes are cut into, each with initial states of its own.
struct ShortRunOptions {
  int readings;        ///< of one run
  std::size_t most;    ///< of more runs effects are tried on so many, spread over the log
  std::size_t starts;  ///< of these that starts are tried on
};

/// Thresholds, calibrated by `hydroscope benchmark state-machines` (docs/state_models.md).
struct ExplainStatesOptions {
  int max_effects = 3;    ///< hidden at once
  int beam = 3;           ///< sets that are extended by a further effect
  int most_rows = 20000;  ///< that effects are tried on; of more, pieces spread over the log ...
  int piece_rows = 2500;  ///< ... of so many rows each
  /// Readings that are means (Episode::mean_rows): a machine that hunts keeps its phase over so many, and less than a tenth of
  /// them tells where a run begins.
  ShortRunOptions means = {25, 15, 5};
  /// Where noise acts on the process: over so many rows it adds up to little.
  ShortRunOptions noisy = {50, 60, 20};
  /// Noise acts on the process where functions predict less than this share of what whole episodes leave ...
  double covered_share = 0.5;
  /// ... and short runs leave less than this share of an output's rms error there.
  double covered_error = 0.5;
  /// ... unless a parameter that drifts over the log takes away as much as this of it.
  double drifts_share = 0.5;
  /// What short runs leave is no all-clear where an output has no readings in this share of the rows, so many and more at a time.
  double blind_share = 0.1;
  int blind_rows = 12;
  ScreeningOptions screening;
  int contenders = 6;  ///< sets of a size that are fitted; the others are left at what linearisation foresees
  int laws_beside = 3;  ///< laws of general shape fitted beside the set found, those foreseen to gain most
  double contender_share = 0.1;  ///< of what the best contender is foreseen to gain: less is tried last
  double worth_a_fit = 0.5;   ///< of the gain that counts where nothing structured is left: less is not tried
  int screen_iterations = 6;  ///< of each start of a candidate; the best is fitted on
  double screen_tolerance = 1e-3;
  int candidate_iterations = 25;  ///< of the best start
  double candidate_tolerance = 1e-5;
  double few_t = 1;    ///< least t of any gain: an effect may act in a few pieces only
  double min_t = 2.5;  ///< gain over its standard error by pieces of the log
  /// Energy removed on pieces left out, in noise variances, where nothing structured is left.
  double min_gain = 40;
  double sure_t = 4;  ///< ... and its t there
  /// Of the energy that functions can predict: what a further effect must take away.
  double min_removed = 0.2;
  /// Of all that is left where nothing is named: from which share on the best single effect is told as nearest; and others beside it
  /// that remove less by no more than this share of what it removes.
  double nearest_removed = 0.1;
  double hardly_follows = kHardlyFollows;  ///< error over an output's variation that allows no verdict
  /// Of that energy: what a complete explanation may leave; of n effects 1/n^2 of it.
  double left_share = 0.04;
  /// A set stands against a limit in doubt if it leaves less than the machine does without that limit, divided by this.
  double limit_margin = 2;
  /// Share of what a set explains that an effect too weak to be told from laws without a name may have in it: of more, no effect of
  /// the set is named.
  double leans_share = 0.04;
  /// Energy that the past of inputs predicts, of that which a set explains: of more, the set may only stand in for missing dynamics.
  double dynamics_share = 0.25;
  /// Energy of an error that lasts, of that which a set explains (SlowShare): of more, the set may only stand in for a part. An
  /// overflow that stands in for one that spills into the next tank leaves 0.76, a right name beside noise of the process 0.7 to 1.
  double slow_share = 1.0;
  double same_law = 0.1;  ///< terms of two effects that differ by no more than this share are one law
  /// Share of a set's terms that the nearest of another set may differ by to be fitted from there.
  double near_law = 0.5;
  /// Share of what the best set removes from which on another is fitted from afar, too; a single effect is then told beside the
  /// nearest, unless it is clearly worse (rival_t).
  double rival_removed = 0.5;
  /// Readings over which errors are correlated, from which on what is left is no white noise: of that their scatter leaves less
  /// than 1.2 from 1000 readings on.
  double white_readings = 1.5;
  double rival_gain = 12;  ///< sets within this of the best, in noise variances, stay rivals ...
  double rival_t = 2.5;    ///< ... and those that are not worse by so many standard errors
  /// ... if they leave no more than this share of what the best removed beyond it.
  double rival_share = 0.02;
  StateFitOptions fit;
  StateRemainderOptions remainder;
  SpecificityOptions specificity;
  int threads = 1;  ///< that effects are tried on, 0: one per core (ThreadsOf); what is found is the same
  std::function<void(const std::string&)> tells = {};  ///< hears what is being done, from any of the threads
};

struct StatesExplanation {
  Verdict verdict = Verdict::kUnknown;
  std::vector<std::string> set;                  ///< best first
  std::vector<std::vector<std::string>> groups;  ///< per hidden effect, those that may be it
  bool astray = false;                           ///< unknown: the free run hardly follows what was measured
  bool partial = false;  ///< unknown: `nearest` explains part of it; named: a little is left
  /// Effects that explain a part, but may stand for a law nobody has named.
  std::vector<std::string> nearest;
  double unexplained = 0;  ///< predictable energy that the set leaves, of what was there
  std::vector<Told> warnings;
  StateCandidate base, final;
  std::vector<StateCandidate> rivals;  ///< of `final`, that do as well
  /// That the fits above are of, where the episodes were cut (ShortRuns); else empty.
  std::vector<Episode> runs;
  StateRemainder base_left, final_left;
  std::optional<double> dynamics;                     ///< FindMissingDynamics of `final`
  std::optional<ParameterDrift> drift;                ///< ... and FindParameterDrift
  std::vector<StateCandidate> ranking;                ///< single effects, best first; some as foreseen
  std::map<std::string, EffectSeen> not_seen;         ///< effects that these episodes cannot show, and why
  std::vector<std::pair<std::string, double>> steps;  ///< effect added ("" = none), ErrorLeftOut

  /// ErrorLeftOut of `base` over what it is on the episodes that `ranking` was fitted on.
  double scale_of_tried = 1;

  /// Whether something is missing at all is in doubt: unknown for lack of an all-clear.
  bool only_doubtful() const { return base_left.MayHideLaw() && final.added.empty(); }

  /// Predictable energy that a set leaves, of what was there; `left`: by it.
  double Unexplained(const StateCandidate& by, const StateRemainder& left) const;
  /// A share of what the final set leaves, of what it explains.
  double OfExplained(double share) const;
  /// Of what the final set explains, what it leaves that lasts over many rows and that no function predicts: no noise of sensors.
  /// 0: nothing does.
  double SlowShare() const;

  /// Nothing is named; `helped`: the effects that explain a part.
  void LeaveUnknown(std::vector<std::string> helped);

  /// What is left is no noise, though nothing predicts it: no all-clear, and what is named is flagged.
  void LeaveDoubt();

  /// Its effects stand beside the one of the set that it does without, which makes the verdict ambiguous.
  void AddRival(StateCandidate rival);
};

/// Which effects of the machine file explain what its model leaves. Sets of effects are screened by linearisation about the
/// fit without the last of them, the contenders are fitted and compared on pieces of the log left out; a further effect is taken
/// as long as functions of states and inputs could predict what is left. `named` only if nothing of that is left (or next to
/// nothing of it), else `unknown`.
StatesExplanation ExplainStates(const Machine& machine, std::span<const Episode> episodes,
                                const ExplainStatesOptions& options = {});

}  // namespace hydroscope
