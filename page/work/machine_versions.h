#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// Every version of a machine file that is kept beside it, branches too: the entries of ModelHistoryJson, each with
/// `parent` (version it was made from, null of the first) and `current`. Error: the file cannot be read.
Result<nlohmann::json> VersionsJson(const std::string& machine_file);

/// Brings back a version that is kept beside; nothing is lost by it. Error: it is not kept.
Status RestoreKept(const std::string& machine_file, int version);

/// Puts the file `next` in place of the machine file, whose present version `version` is kept beside.
Status PutVersion(const std::string& machine_file, int version, const std::string& next);

}  // namespace hydroscope
