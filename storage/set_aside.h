#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// Renames an SQLite file with what lies beside it to a name with the date: "press.db" to
/// "press.20261122T101500Z.db". Whoever has it open keeps it. `wall` in s since 1970. Returns the new name.
Result<std::string> SetAside(const std::string& path, double wall);

}  // namespace hydroscope
