#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "models/machine.h"
#include "pipeline/run_summary.h"
#include "storage/database.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// Noise as a log was found to have it at its end; nothing if nobody looked.
std::optional<NoiseScales> NoiseOf(const RunSummary& summary);

/// Noise of a live service's strokes, which no end of a log ever judged: by the newest of them whose rows are kept in the database
/// `path`. Explaining them takes as long as `explain` does, so the process remembers what came out while strokes and machine are
/// the same. Nothing if no rows are kept.
std::optional<NoiseScales> NoiseOfKeptRows(const Database& database, const std::string& path,
                                           const RunInfo& run, std::int64_t machine_id,
                                           const Machine& machine);
/// How many times that was worked out and not remembered, for tests.
std::int64_t NoiseOfKeptRowsWorkedOut();

}  // namespace hydroscope
