#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/records/estimate.h"
#include "core/units.h"
#include "diagnosis/states/explain_states.h"
#include "diagnosis/states/missing_sensors.h"
#include "diagnosis/states/other_causes/missing_dynamics.h"
#include "diagnosis/states/other_causes/missing_limit.h"
#include "diagnosis/states/other_causes/missing_zero.h"
#include "diagnosis/states/other_causes/parameter_drift.h"
#include "diagnosis/states/other_causes/sampling.h"
#include "diagnosis/states/other_causes/state_limit.h"
#include "diagnosis/states/state_experiment.h"
#include "estimation/linear_form/starts.h"
#include "estimation/states/one_step.h"
#include "models/model_history.h"
#include "pipeline/episodes.h"
#include "workbench/states/states_location.h"

namespace hydroscope {

/// Whether a machine file describes states, and so goes the way of this file. False if it cannot be read: the command's own
/// way says why.
bool HasStates(const std::string& machine_file);

/// Error of one step over that of the free run, below which it is no white noise: from 1000 readings on, scatter leaves more than
/// 0.98 of such noise.
inline constexpr double kColouredError = 0.8;

/// How large errors of a model with states are, as shown. Of one output in its unit; of several as a share of each output's
/// variation, root of the mean of squares.
struct StatesError {
  double rms = 0;          ///< free run, on the rows of the fit
  double rms_holdout = 0;  ///< on pieces of the log left out
  double noise_floor = 0;  ///< what no function of states and inputs could predict
  /// What is left where past errors may be used: large against noise, small here = the process is noisy.
  double one_step = 0;
  DisplayUnit unit;
  bool of_variation = false;  ///< several outputs: each over its variation

  /// It lasts over many rows.
  bool slow() const { return one_step < kSlowError * rms; }
  /// It is no white noise.
  bool coloured() const { return one_step < kColouredError * rms; }
};

/// A model with states fitted to logs.
struct StatesFit {
  /// Errors last over many rows, and no function of states and inputs predicts them.
  bool slow() const { return !left.structured && error.slow(); }
  /// What is left is no white noise, no function predicts it, and it is so much that the run hardly follows the machine.
  bool astray() const {
    return !left.structured && error.coloured() && fit.ErrorOfVariation() > kHardlyFollows;
  }
  /// What is left is no white noise, and a law may be in it that the log shows too seldom.
  bool may_lack_law() const { return !left.structured && left.MayHideLaw() && error.coloured(); }
  bool noise_alone() const {
    return !left.structured && !may_lack_law() && !astray() && !slow() && !dynamics && !other_sampling;
  }

  EpisodeLog log;
  StateFit fit;
  std::optional<LinearFit> linear;  ///< where the fit began, of kinds with a linear form
  StateRemainder left;
  std::optional<OtherSampling> other_sampling;
  std::optional<MissingZeros> zeros;  ///< that were taken, though the machine file lacks them
  std::optional<DoubtedLimit> doubted_limit;
  std::optional<MissingLimit> missing_limit;
  std::optional<ParameterDrift> drift;  ///< over the log
  std::optional<double> dynamics;       ///< FindMissingDynamics
  StatesError error;
  /// Where noise acts on the process itself: fitted by one-step prediction, which `parameters` are of then.
  std::optional<StateFit> prediction;
  std::vector<Estimate> parameters;
  ToldTogether told_together;
  std::vector<double> one_step;  ///< per output, SI
  /// Shown unit, free run on the log held out; initial states are estimated there.
  std::optional<double> held_out;
  std::string held_out_log;
  int held_out_episodes = 0;
  std::vector<OutputErrors> located;  ///< of `compare`
};

/// `fit`. Errors: logs, machine file, a model that diverges from every start.
Result<StatesFit> FitStatesLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                const std::string& hold_out);
/// `compare`: the same, and where it errs.
Result<StatesFit> CompareStatesLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                    const std::string& hold_out);
/// Hears what is being done, from any thread.
using WorkListener = std::function<void(const std::string& what)>;
/// The same on episodes that were read.
Result<StatesFit> FitEpisodes(EpisodeLog log, const WorkListener& tells = {});

/// `explain`.
struct StatesExplained {
  std::string target;  ///< how the command line names the machine
  EpisodeLog log;
  StatesExplanation explanation;
  std::optional<MissingZeros> zeros;  ///< that were taken, though the machine file lacks them
  StateExperiment experiment;         ///< what to record next
  StatesError base, final;
  std::vector<Estimate> base_parameters, final_parameters;
  std::vector<OutputErrors> located;  ///< of the model as it is
  std::optional<ShownLaw> missing;    ///< verdict unknown: what is missing in the model with what was found

  /// What the set found leaves is noise for all that can be seen.
  bool noise_alone() const {
    return !explanation.final_left.structured && !explanation.astray && !explanation.dynamics &&
           !final.slow();
  }
  /// The model describes the log but for constants that the machine file lacks: zeros of sensors, or a law.
  bool only_zeros() const {
    return zeros && explanation.verdict == Verdict::kUnknown && noise_alone() && !explanation.drift &&
           !explanation.only_doubtful() && explanation.runs.empty() && explanation.final.added.empty();
  }
  /// Nothing is named, and yet errors last over many rows (StatesFit::slow).
  bool slow() const { return explanation.verdict == Verdict::kAdequate && base.slow(); }
};
Result<StatesExplained> ExplainStatesLogs(const std::vector<std::string>& logs,
                                          const std::string& machine_file);
/// The same on episodes that were read.
Result<StatesExplained> ExplainReadEpisodes(EpisodeLog log, const WorkListener& tells = {});

/// What a model achieves, for its history.
ModelRecord RecordOf(const StatesFit& fit, const std::string& source);

std::vector<Estimate> EstimatesOf(const StateFit& fit);
StatesError ErrorOf(const StateFit& fit, const StateRemainder& left);

/// "t, measured, simulated" of every row of the fit as CSV. Error: the file cannot be written.
Status WriteStatesCsv(const StatesFit& fit, const std::string& path);

}  // namespace hydroscope
