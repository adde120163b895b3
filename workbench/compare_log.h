#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/non_negative.h"
#include "diagnosis/explain.h"
#include "diagnosis/remainder/locate.h"
#include "diagnosis/remainder/whiteness.h"
#include "workbench/explain/headline.h"
#include "workbench/explain/odd_text.h"
#include "workbench/held_out_log.h"
#include "workbench/history/stroke_history.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {

/// What a comparison says where `explain` gives no verdict, and of which signal. Of chance alone but for `visible_error`.
struct CompareThresholds {
  double family_error = 0.01;  ///< chance that some signal is called correlated when none is (Bonferroni)
  double pattern_p = 1e-4;  ///< p-value of the Ljung-Box test below which what is left has a pattern in time
  /// Standard errors of the excess energy above 0 (ErrorLocation), as ExplainOptions::min_t.
  double excess_errors = 4;
  /// Error over the noise floor from which it is seen with the eye: 10 % more energy.
  double visible_error = 1.05;
  /// Correlation at another time over the one at the same time, if it is to be told.
  double clearly_more = 1.25;
};

/// Measured against modelled output of one stroke, SI.
struct StrokeComparison {
  std::int64_t stroke = 0;  ///< index within the log, 0, 1, ...
  double begin = 0;         ///< s
  std::string log = {};     ///< file it is of; "" = of a database
  int windows = 0;
  double rms_measured = 0, rms_modelled = 0, rms_residual = 0, noise_floor = 0;
  /// SI, rms error of the channel that the model runs by itself; see FreeRun.
  std::optional<double> free_run;

  /// rms of what is above the noise.
  double model_error() const {
    return std::sqrt(NonNegative(rms_residual * rms_residual - noise_floor * noise_floor));
  }
  /// Error over the measured output; 0 where nothing was measured.
  double relative_error() const { return rms_measured > 0 ? rms_residual / rms_measured : 0.0; }
};

/// Everything `hydroscope compare` knows of the logs of one machine.
struct CompareResult {
  LogStrokes log;
  std::size_t strokes = 0;  ///< compared: those whose samples were kept
  std::string described;    ///< which strokes these are, a line; "" = all of a log
  MachineModel model;
  Residuals residuals;
  /// That differ from the rest (Explanation::odd_strokes): left out of the model and of everything here but `per_stroke` and
  /// `residuals`, where they stand beside the model of the others.
  std::vector<ToldOddStrokes> odd;
  StrokeComparison overall;  ///< MachineModel::figures
  double rms_run = 0;        ///< SI, of the channel of overall.free_run as measured
  std::vector<StrokeComparison> per_stroke;
  Whiteness whiteness;
  std::vector<SignalCorrelation> correlations;
  ErrorLocation location;
  std::vector<std::string> warnings;     ///< what makes the result doubtful, a sentence each
  std::optional<HeldOutError> held_out;  ///< on the log that was held out
  /// That `explain` gives on these strokes; nothing if they are too few for it.
  std::optional<Verdict> verdict;
  bool may_be_noise = false;  ///< Explanation::may_be_noise
  Told no_verdict;            ///< why `explain` gives none, "" if it does (Explanation::no_verdict)

  LeftOut left_out() const;
  /// Index into per_stroke of the stroke with the largest error above its noise.
  std::size_t WorstStroke() const;
  /// Of too few strokes for a verdict there is more than noise if the error is far above 0, or located, or a pattern in time.
  ErrorFinding Found() const;
  bool HasPattern() const;  ///< in time, block by block, of what is left
  bool IsSignificant(const SignalCorrelation& c) const;
  /// Whether what is left follows the signal clearly more at another time.
  bool IsLagged(const SignalCorrelation& c) const;
};

/// Fits the machine file's model (base and added effects) to logs of one machine and compares it with the
/// measurement; its error is also given on the log `hold_out` (path or file name, "" = none), which it is not
/// fitted to. Errors: a log or the machine file is wrong, fewer than two strokes, or strokes that do not
/// excite the model.
Result<CompareResult> CompareLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                  const std::string& hold_out = {});

/// What `explain` says of the strokes becomes the comparison's own word, its model of those that do not differ the one compared.
void TakeVerdict(const Explanation& explanation, CompareResult& out);

/// The model that an explanation fitted without the strokes that differ from the rest; its figures stay.
void TakeModelOfTheRest(const Explanation& explanation, MachineModel& model);

/// MachineModel::figures as a comparison of all strokes.
StrokeComparison OverallOf(const GramFit& figures);

/// Compares the stored model of a history with its strokes, from their sums alone: errors per group of
/// strokes, without what needs samples (whiteness, correlations, maps, free run). `per_stroke` holds a group
/// each, `stroke` its first number. Errors: fewer than two groups, or strokes that do not excite the model.
Result<CompareResult> CompareHistory(const StrokeHistory& history);

}  // namespace hydroscope
