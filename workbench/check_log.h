#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "estimation/gram_fit.h"
#include "models/machine.h"
#include "models/machine_kind.h"
#include "pipeline/log_pass.h"
#include "pipeline/log_trust.h"
#include "pipeline/signal_survey.h"
#include "workbench/condition_ranges.h"
#include "workbench/fit_suspicion.h"

namespace hydroscope {

/// One signal of the log as `hydroscope check` shows it.
struct CheckedSignal {
  SignalSpec spec;
  SignalRange range;
  double noise_std = 0;  ///< SI, white sensor noise; NaN if not known
  bool present = true;   ///< false: optional and not in this log
};

/// What can be said about one parameter from this log.
enum class Identifiability { kGood, kWeak, kNot };
const char* IdentifiabilityName(Identifiability verdict);

struct CheckedParameter {
  Estimate estimate;  ///< of the batch fit; only `parameter` and `unit` if there is no fit
  Identifiability verdict = Identifiability::kNot;
  bool explain_first = false;                ///< `advice` is to find what the model misses
  Told reason;                               ///< why it is not good, "" if it is
  Told advice;                               ///< what to record to get it, "" if it is good
  std::vector<std::string> confounded_with;  ///< Confounding::effects
  double confounded_bias = 0;                ///< SI
};

/// How the machine was driven inside the gate.
struct Driving {
  int strokes = 0;
  std::int64_t too_short = 0;
  std::vector<ConditionRange> ranges;  ///< of the machine's conditions, all zero without strokes
  double oil_min = 0, oil_max = 0;     ///< K, NaN if not measured
  MachineWords words = WordsOf({});
  bool of_one_log = false;  ///< `strokes` are pieces that the log was cut into
};

struct CheckResult {
  std::string log;
  Machine machine;
  LogPass pass;
  double sample_period = 0;  ///< s
  TimeSurvey time;
  Told time_base;  ///< LogCounters::time_base
  std::vector<CheckedSignal> signals;
  std::vector<ConditionSurvey> conditions;
  GateSurvey gate;
  Driving driving;
  std::vector<CheckedParameter> parameters;  ///< empty if the machine has no balance (valve)
  GramFit figures;                           ///< FitResult::fit; all 0 if there is no fit
  /// figures.noise_floor is more than noise: what no function of a model's states predicts, or a run that hardly follows.
  bool noise_at_most = false;
  std::string no_fit;       ///< why there is no fit, or nothing that `frf` could measure; "" otherwise
  LogTrust trust;           ///< of noise and sampling rate
  FitSuspicion suspicion;   ///< what the model may miss
  std::vector<Told> hints;  ///< what looks wrong in units, signs, gate

  /// No row or value had to be left out because of its quality.
  bool Clean() const;
  /// Its parameters are asked for, and none of them can be identified.
  bool NothingIdentified() const;
};

/// Looks at a log without changing anything. Errors: machine file or log cannot be used at all.
Result<CheckResult> CheckLog(const std::string& log, const std::string& machine_file);

}  // namespace hydroscope
