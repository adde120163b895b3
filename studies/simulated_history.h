#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "pipeline/batch_fit.h"
#include "storage/database.h"

namespace hydroscope {

/// Stores `strokes` strokes as one finished run of the machine `name`: those of `log` over and over. `model_text` is the
/// machine file they count as identified with. The newest `grams` have their Grams, older ones empty ones of a few
/// bytes. `progress` hears how many are stored.
Status StoreOverAndOver(Database& database, const std::string& name, const std::string& model_text,
                        const LogStrokes& log, std::int64_t strokes, std::int64_t grams,
                        const std::function<void(std::int64_t)>& progress = {});

}  // namespace hydroscope
