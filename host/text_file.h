#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// All bytes of a file. Error: it cannot be read.
Result<std::string> ReadTextFile(const std::string& path);

}  // namespace hydroscope
