#pragma once

#include <regex>
#include <string>

namespace hydroscope {

/// Text that was wrapped to fit a line, on one line again.
inline std::string Unwrapped(const std::string& text) {
  return std::regex_replace(text, std::regex("\n +"), " ");
}

}  // namespace hydroscope
