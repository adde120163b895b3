#pragma once

#include <vector>

#include "models/model_structure.h"
#include "review/replay_runner.h"
#include "storage/database.h"

namespace hydroscope {

/// Reads runs, latest parameters, totals and what was skipped back from the database, over all runs of the
/// machine, into `outcome`, whose `logs` are complete.
Status CollectOutcome(const Database& database, std::int64_t machine_id, const ModelStructure& model,
                      ReplayOutcome& outcome);

/// The report over all runs of the machine.
Result<ReportInput> MakeReportInput(const Database& database, std::int64_t machine_id,
                                    const ReplayOutcome& outcome, std::vector<StrokeOverlay> overlays);

}  // namespace hydroscope
