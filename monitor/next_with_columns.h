#pragma once

#include <cstdint>

#include "core/result.h"
#include "storage/database.h"

namespace hydroscope {

/// First stroke of a machine from `sequence` on whose Gram may have so many columns, by what is stored of each run: a long history of
/// another model need not be read.
Result<std::int64_t> NextWithColumns(const Database& database, std::int64_t machine, int columns,
                                     std::int64_t sequence);

}  // namespace hydroscope
