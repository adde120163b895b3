#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// All bytes of a file. Error: it cannot be read.
Result<std::string> ReadTextFile(const std::string& path);
/// Error: it cannot be written.
Status WriteTextFile(const std::string& path, const std::string& text);

}  // namespace hydroscope
