#pragma once

#include <string>

namespace hydroscope {

/// "2026-03-01 14:05:09", UTC, of seconds since 1970.
std::string UtcText(double wall);

}  // namespace hydroscope
