#pragma once

#include "core/records/stroke_record.h"
#include "storage/connection.h"

namespace hydroscope {

/// Columns of the table `stroke` that make a StrokeSummary, in the order ReadStrokeRow takes them.
inline constexpr const char* kStrokeColumns =
    "begin_s, end_s, oil_temperature_K, condition_0, condition_1, condition_2, condition_3, condition_4, "
    "condition_5, rms_error, noise_floor, rows_seen, rows_gated, rows_used";

/// The summary of stroke `index` from a row of kStrokeColumns, its first one at column `first`.
StrokeSummary ReadStrokeRow(const Query& query, int first, std::int64_t index);

}  // namespace hydroscope
