#pragma once

#include <string>

#include "core/result.h"

namespace hydroscope {

/// All bytes of a file; "" where it cannot be read.
std::string ReadWhole(const std::string& path);
/// Error: it cannot be written.
Status WriteWhole(const std::string& path, const std::string& text);

}  // namespace hydroscope
