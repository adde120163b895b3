#pragma once

#include <span>
#include <vector>

#include "storage/connection.h"
#include "storage/live_batch.h"

namespace hydroscope {

/// Steps of storing that several calls of Database share; they run inside the caller's transaction.

/// Adds strokes behind those the run has; `run` is updated.
Status AppendStrokes(Connection& connection, RunRow& run, std::span<const PackedStroke> strokes);

/// Time (s) up to which rows of the run were stored, whether still kept or not; -infinity if there were none.
double RawStoredUntil(Connection& connection, std::int64_t run);

/// Adds raw rows behind those the run has and drops the machine's oldest beyond the limits.
Status AppendRaw(Connection& connection, const RunRow& run, const std::vector<std::string>& signals,
                 std::span<const RawChunk> chunks, const RawLimits& limits);

}  // namespace hydroscope
