#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/result.h"
#include "diagnosis/closed_loop/change.h"
#include "workbench/frequency_response/loop_log.h"

namespace hydroscope {

/// The machine file is of a kind that is measured in closed loop; false where it cannot be read.
bool IsClosedLoop(const std::string& machine_file);

/// Such a machine as it was: as the log `since` has it or, if that is "", as the references of its machine file do (a delay of 0
/// where there is none).
/// Errors: kUsage where neither is there; those of MeasureLoopLog; the log gives no model.
Result<LoopState> LoopStateBefore(const std::string& since, const Machine& machine);

/// What changed of it.
struct LoopChangeResult {
  Machine machine;
  std::string since;  ///< the log before; "": the references of the machine file
  LoopLog after;
  LoopComparison comparison;
};

/// What changed from `since` (LoopStateBefore) to `log`.
Result<LoopChangeResult> ExplainLoopLog(const std::string& log, const std::string& since,
                                        const std::string& machine_file);

/// For people, and for scripts (keys: docs/test_cylinder.md).
std::string LoopChangeText(const LoopChangeResult& result);
nlohmann::json LoopChangeJson(const LoopChangeResult& result);

}  // namespace hydroscope
