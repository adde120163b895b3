#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hydroscope {

/// The document as JSON that may also stand on a terminal: bytes that are no UTF-8 (a file's name may hold any) become U+FFFD, and
/// what would control the terminal or turn the direction of writing is escaped as \uNNNN. `indent`: blanks a level; -1: one line.
std::string JsonText(const nlohmann::json& document, int indent = -1);

}  // namespace hydroscope
