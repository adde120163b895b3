#pragma once

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/explain.h"
#include "diagnosis/remainder/locate.h"
#include "diagnosis/remainder/whiteness.h"
#include "workbench/held_out_log.h"
#include "workbench/history/stroke_history.h"
#include "workbench/model/machine_model.h"

namespace hydroscope {

/// Measured against modelled flow of one stroke, m^3/s.
struct StrokeComparison {
  std::int64_t stroke = 0;  ///< index within the log, 0, 1, ...
  double begin = 0;         ///< s
  std::string log = {};     ///< file it is of; "" = of a database
  int windows = 0;
  double rms_measured = 0, rms_modelled = 0, rms_residual = 0, noise_floor = 0;
  std::optional<double>
      free_run;  ///< Pa, rms error of the pressure that the model runs by itself; see FreeRun
};

/// Everything `hydroscope compare` knows of the logs of one machine.
struct CompareResult {
  LogStrokes log;
  std::size_t strokes = 0;  ///< compared: those whose samples were kept
  std::string described;    ///< which strokes these are, a line; "" = all of a log
  MachineModel model;
  Residuals residuals;
  StrokeComparison overall;  ///< MachineModel::figures
  double rms_pressure = 0;   ///< Pa, measured, beside overall.free_run
  std::vector<StrokeComparison> per_stroke;
  Whiteness whiteness;
  std::vector<SignalCorrelation> correlations;
  ErrorLocation location;
  std::vector<std::string> warnings;     ///< what makes the result doubtful, a sentence each
  std::optional<HeldOutError> held_out;  ///< on the log that was held out
  std::optional<Verdict>
      verdict;      ///< that `explain` gives on these strokes; nothing if they are too few for it
  Told no_verdict;  ///< why `explain` gives none, "" if it does (Explanation::no_verdict)

  /// Index into per_stroke of the stroke with the largest error above its noise.
  std::size_t WorstStroke() const;
};

/// Fits the machine file's model (base and added effects) to logs of one machine and compares it with the
/// measurement; its error is also given on the log `hold_out` (path or file name, "" = none), which it is not
/// fitted to. Errors: a log or the machine file is wrong, fewer than two strokes, or strokes that do not
/// excite the model.
Result<CompareResult> CompareLogs(const std::vector<std::string>& logs, const std::string& machine_file,
                                  const std::string& hold_out = {});

/// What `explain` says of the strokes compared becomes the comparison's own word.
void TakeVerdict(const Explanation& explanation, CompareResult& out);

/// MachineModel::figures as a comparison of all strokes.
StrokeComparison OverallOf(const GramFit& figures);

/// Compares the stored model of a history with its strokes, from their sums alone: errors per group of
/// strokes, without what needs samples (whiteness, correlations, maps, free run). `per_stroke` holds a group
/// each, `stroke` its first number. Errors: fewer than two groups, or strokes that do not excite the model.
Result<CompareResult> CompareHistory(const StrokeHistory& history);

}  // namespace hydroscope
