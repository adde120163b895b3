#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// What a SCADA system sees in the registers of the Modbus feed at "HOST:PORT": axes, alarms, the newest
/// rows of the journal; with `acknowledge` > 0 acknowledges that alarm first. `json`: file for the same as
/// JSON, "-" is stdout, "" none.
Status ShowScada(const std::string& endpoint, int acknowledge, const std::string& json);

}  // namespace hydroscope
