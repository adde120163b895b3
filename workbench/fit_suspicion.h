#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// What the chain of `explain` says of the strokes that a fit rests on. Where the model misses something, the
/// parameters absorb part of it, and their intervals, which know of noise alone, do not show it.
struct FitSuspicion {
  std::string verdict;                ///< of `explain`, "" if it gave none
  std::vector<std::string> suspects;  ///< ids of the effects that may be missing, best first
  std::vector<Told> warnings;         ///< a sentence each, those of `explain` first
  bool suspected = false;             ///< the parameters may lie outside their intervals
  bool judged = true;                 ///< by strokes that carry a verdict

  bool ExplainSaysMore() const { return suspected && judged; }
};

/// The suspicion that an explanation of the same strokes carries. Strokes too few or too little varied for a verdict
/// are a warning, not an error.
FitSuspicion SuspicionOf(const Result<ExplainResult>& explained);

/// Lines below the table of parameters, for people.
std::string SuspicionText(const FitSuspicion& suspicion);
/// Into the JSON of `fit` or `check`: `verdict`, `suspects` and `warnings`, after those that are there, in German too where
/// it has `german`.
void AddSuspicion(const FitSuspicion& suspicion, nlohmann::json& json);

}  // namespace hydroscope
