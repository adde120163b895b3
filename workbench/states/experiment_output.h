#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "workbench/states/states_log.h"

namespace hydroscope {

/// What to record next on a machine with states, a sentence; nothing: nothing is asked for.
std::optional<Told> StatesToRecord(const StatesExplained& explained);
/// The records that were simulated, best first, as a table; "" if none was, or none helps.
std::string RecordTable(const StatesExplained& explained);
/// `experiment_plan` (docs/command_line.md); null where nothing is proposed.
nlohmann::json ExperimentPlanJson(const StatesExplained& explained);

}  // namespace hydroscope
