#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/limits.h"
#include "core/records/estimate.h"
#include "core/records/stroke_record.h"
#include "core/result.h"
#include "models/machine.h"
#include "storage/database.h"

namespace hydroscope {

/// Parameters of a block of consecutive strokes, fitted to these strokes alone: first <= sequence < last.
struct BlockEstimates {
  std::int64_t first = 0, last = 0;
  double oil_temperature = 0;  ///< K, mean over the strokes; NaN if not measured
  /// Base parameters, then effects as "internal_leakage.G". `std` holds what strokes scatter by, not the
  /// uncertainty of the geometry, which all blocks share; NaN of a block of one unit.
  std::vector<Estimate> parameters;
  std::array<double, kMaxConditions> conditions{};  ///< means of StrokeSummary::conditions; NaN as there
  double error = 0;  ///< model error energy over noise energy that the block's own fit leaves; 0 = none
};

/// What a machine's record says about change, in independent pieces: successive estimates of the recursive
/// estimator share most of their strokes, these blocks share none. Some 40 blocks of at least
/// kLeastBlockStrokes strokes (of more than 1024 strokes, of 64 or more, from the stored sums), fitted with
/// the model of `machine`, effects included; shapes of effects are chosen once for all blocks. Blocks that
/// do not determine all parameters are left out. Errors: strokes recorded with other Gram columns or sample
/// periods than the rest.
Result<std::vector<BlockEstimates>> EstimateBlocks(const Database& database, std::int64_t machine_id,
                                                   const Machine& machine,
                                                   const std::vector<StrokeSummary>& strokes);

inline constexpr std::int64_t kLeastBlockStrokes = 3;

}  // namespace hydroscope
