#pragma once

#include <string>

#include "core/result.h"
#include "models/model_structure.h"

namespace hydroscope {

/// Index of an effect in the model's library. Error: unknown id (names the nearest one) or a signal is missing.
Result<int> FindEffect(const ModelStructure& model, const std::string& id);

}  // namespace hydroscope
