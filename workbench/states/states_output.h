#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/states/states_log.h"

namespace hydroscope {

/// What `fit`, `compare` and `explain` say of a machine with states: keys as of any machine where they mean the same, a
/// stroke being an episode (docs/command_line.md).
std::string FitText(const StatesFit& fit);
nlohmann::json FitJson(const StatesFit& fit);
std::string CompareText(const StatesFit& fit);
nlohmann::json CompareJson(const StatesFit& fit);
std::string ExplainText(const StatesExplained& explained);
nlohmann::json ExplainJson(const StatesExplained& explained);

}  // namespace hydroscope
