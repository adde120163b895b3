#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// The machine file is of a kind that is measured in closed loop; false where it cannot be read.
bool IsClosedLoop(const std::string& machine_file);

/// `explain` of such a machine: what changed from the log `since` (if "": from the references of the machine file) to `log`, as
/// text on stdout and as JSON to `json` ("": none, "-": in place of the text).
Status ExplainClosedLoop(const std::string& log, const std::string& since, const std::string& machine_file,
                         const std::string& json);

}  // namespace hydroscope
