#pragma once

#include <string>

#include "core/result.h"
#include "live/scada_client.h"

namespace hydroscope {

/// Value and 95 % interval of an alarm in the unit that its name tells (the map carries SI numbers alone), else in SI; "" of
/// a loss of signals, which has none.
std::string ScadaAlarmValue(const ScadaAlarm& alarm);

/// What a SCADA system sees in the registers of the Modbus feed at "HOST:PORT": axes, alarms, the newest
/// rows of the journal; with `acknowledge` > 0 acknowledges that alarm first. `json`: file for the same as
/// JSON, "-" is stdout, "" none.
Status ShowScada(const std::string& endpoint, int acknowledge, const std::string& json);

}  // namespace hydroscope
