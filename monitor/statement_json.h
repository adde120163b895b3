#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/records/estimate_statement.h"

namespace hydroscope {

/// `statements[]` of docs/serve.md, and back from there.
nlohmann::json StatementJson(const EstimateStatement& statement);
EstimateStatement StatementOf(const nlohmann::json& json);

}  // namespace hydroscope
