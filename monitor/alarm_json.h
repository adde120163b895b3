#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/records/alarm_records.h"

namespace hydroscope {

/// An alarm as `alarms list --json` and the page tell it, SI units.
nlohmann::json AlarmJson(const std::string& machine, const AlarmState& alarm);
/// A row of the journal as `alarms journal --json` and the page tell it, SI units.
nlohmann::json JournalRowJson(const JournalRow& row);

}  // namespace hydroscope
