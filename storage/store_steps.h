#pragma once

#include <vector>

#include "storage/connection.h"

namespace hydroscope {

/// Steps of storing that several calls of Database share; they run inside the caller's transaction.

/// Adds strokes behind those the run has; `run` is updated.
Status AppendStrokes(Connection& connection, RunRow& run, const std::vector<StrokeRecord>& strokes);

/// Adds raw rows behind those the run has and drops the machine's oldest beyond the limits. `flags` may be
/// empty: all values are good.
Status AppendRaw(Connection& connection, const RunRow& run, const std::vector<std::string>& signals,
                 const std::vector<double>& time, const std::vector<std::vector<double>>& values,
                 const std::vector<std::vector<Quality>>& flags, const RawLimits& limits);

}  // namespace hydroscope
