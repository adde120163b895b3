#pragma once

#include <string>

#include "core/result.h"
#include "estimation/closed_loop/closed_loop.h"
#include "models/machine.h"
#include "workbench/frequency_response/frf_record.h"

namespace hydroscope {

/// A log of a machine in closed loop and what was measured of it.
struct LoopLog {
  std::string name;
  FrfRecord log;
  TransferModel model;
  LoopResponse response;
};

/// Reads `path` and measures the response of a machine whose kind is measured in closed loop (MachineKind::closed_loop).
Result<LoopLog> MeasureLoopLog(const std::string& path, const Machine& machine,
                               const LoopOptions& options = {});

/// What a reader has to know of the log's rows: those left out and why, and stamps that gave way.
std::vector<Told> RowWarnings(const FrfRecord& log);

/// What the machine file's [monitor] limits say of the parameters found, a sentence each.
std::vector<Told> OutsideLimits(const Machine& machine, const LoopResponse& response);

}  // namespace hydroscope
