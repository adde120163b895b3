#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/counted_words.h"
#include "diagnosis/experiment/experiment.h"
#include "diagnosis/experiment/signal_experiment.h"
#include "diagnosis/explain.h"
#include "diagnosis/remainder/locate.h"
#include "diagnosis/remainder/remainder_shape.h"
#include "pipeline/log_trust.h"
#include "workbench/explain/confounding.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {

/// An effect of the library that needs a signal the machine does not measure.
struct UnmeasuredEffect {
  std::shared_ptr<const Effect> effect;
  std::vector<std::string> missing;  ///< signals it needs; none: it needs samples, not stored strokes
};

/// "signal p_B is not in the machine file".
Told WhyUnmeasured(const UnmeasuredEffect& unmeasured);

/// Effects of the library that cannot be tried for want of a signal.
std::vector<UnmeasuredEffect> UnmeasuredEffects(const Machine& machine, const ModelStructure& model);
/// Effects of the library whose columns stored strokes do not have (Effect::needs_samples).
std::vector<UnmeasuredEffect> NotStoredEffects(const ModelStructure& model);

/// Everything `hydroscope explain` knows of one log.
struct ExplainResult {
  std::string target;     ///< how the command line names the machine: "--machine press.toml"
  std::string described;  ///< which strokes these are, a line; "" = all of the log
  LogStrokes log;
  std::size_t strokes = 0;  ///< strokes explained: those whose samples were kept
  GramFit base;             ///< MachineModel::figures: the model as it is, of the same strokes
  LogTrust trust;           ///< of the samples; where rows are too far apart there is no verdict
  /// Stored episodes of a machine with states: the error that parameters of its own leave in each, over what white noise would; NaN
  /// of strokes.
  double error_alone = std::numeric_limits<double>::quiet_NaN();
  /// Whether that is white noise: what is more than noise is then what moves from one to the next.
  bool EachAlone() const { return error_alone * error_alone <= 1 + kFloorExcess; }
  Explanation explanation;
  std::vector<Confounding> confounded;           ///< of `base`, whose parameters are marked ...
  std::vector<Confounding> extended_confounded;  ///< ... and of Explanation::final
  std::vector<UnmeasuredEffect> unmeasured;
  ErrorLocation location;                   ///< of the error of the model as it is
  std::vector<ResidualSignal> signals;      ///< that the maps of `location` name
  std::optional<RemainderShape> remainder;  ///< verdict unknown: what Explanation::final leaves
  Experiment experiment;                    ///< verdict ambiguous: what would tell the rivals apart ...
  SignalExperiment signal_experiment;       ///< ... on a machine of the user's own

  /// Base parameters of Explanation::final, those marked that effects could move which these strokes do not show.
  std::vector<Estimate> ExtendedParameters() const;
  const Effect& effect(int index) const { return *explanation.model->effects[index]; }
  /// nullptr if the library has no effect of this name.
  const Effect* FindEffect(const std::string& id) const;
  /// Nonlinear parameters of an effect of the explanation, SI.
  const std::vector<double>& NonlinearOf(const EffectChoice& choice) const {
    return explanation.model->effect_shapes[choice.effect][choice.shape].nonlinear;
  }
};

/// Of the model with the effects `added`, on all strokes of a log.
std::vector<Confounding> ConfoundingsOf(const LogStrokes& log, const std::vector<std::string>& added,
                                        std::span<const Estimate> parameters);
/// ExplainResult::confounded and what goes with it; `grams` are those of the strokes explained.
void TakeConfoundings(std::span<const StrokeGram> grams, ExplainResult& result);

/// What `explain` and `compare` alike find on kept strokes.
struct JudgedModel {
  Explanation explanation;
  LogTrust trust;
};

/// What noise comes to that goes on from row to row, for those who have sums of products alone: its energy in an equation over
/// what neighbouring rows show, how many equations count as one, and the energy of the noise floor (flow form) over that of white
/// noise; nothing: nobody looked. 1 where rows show it.
struct NoiseScales {
  double noise = 1, evidence = 1;
  std::optional<double> floor = 1.0;
};
NoiseScales NoiseScalesOf(const LogStrokes& strokes, const LogTrust& trust);

/// The noise floor that `explain` trusts on these strokes, rms, SI of the output, where rows do not show it; else that of `model`.
double TrustedFloor(const LogStrokes& log, const MachineModel& model);

/// Whether the floor of the verdict is another than that of noise which is white from row to row.
bool HasFloorOfItsOwn(const LogTrust& trust, const Explanation& explanation);

/// The chain of ExplainSamples on the model of the machine file, `model` being MachineModel::structure and `figures`
/// MachineModel::figures: these come back without the strokes that differ from the rest, and with the noise floor that
/// the verdict rests on. `base.solved` is false if the strokes cannot separate its parameters.
JudgedModel JudgeAsExplain(const LogStrokes& log, std::shared_ptr<const ModelStructure> model,
                           GramFit& figures, const ExplainOptions& options = {});

/// Takes the verdict away from strokes that carry none: unknown, `why` (a sentence) before all warnings. "" =
/// it stands.
void RefuseVerdict(const Told& why, Explanation& explanation);
/// Takes an all-clear back, and flags a name, where a parameter of the model is surely where physics allows none (a negative flow
/// gain): a signal turned round leaves a model that fits as well.
void RefuseImpossibleParameters(const Machine& machine, std::size_t strokes, Explanation& explanation);

/// Why so few strokes carry no verdict, "" if they do.
Told TooFewForVerdict(std::size_t strokes, const CountedWords& counted);

/// Reads the logs of one machine, fits the model of the machine file (base balance and the effects added to it) to their
/// strokes and finds what it misses. Errors: a log or the machine file is wrong, fewer than kMinExplainStrokes strokes, or
/// strokes that do not excite the model. ExplainOptions::start is taken from the machine file.
Result<ExplainResult> ExplainLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                  const ExplainOptions& options = {});

/// The same for strokes already read with their samples; ExplainResult::target stays empty.
Result<ExplainResult> ExplainStrokes(LogStrokes strokes, const ExplainOptions& options = {});

}  // namespace hydroscope
