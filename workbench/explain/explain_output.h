#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// What `hydroscope explain` tells a person: verdict, staircase of the error, parameters before and after,
/// every effect tried, what cannot be tested, what to do next.
std::string ExplainText(const ExplainResult& result);

/// The JSON of docs/command_line.md.
nlohmann::json ExplainJson(const ExplainResult& result);

}  // namespace hydroscope
