#pragma once

#include <string>
#include <vector>

#include "page/page_server.h"
#include "simulator/die_cushion/press.h"

namespace hydroscope {

/// Writes the log of a simulated press, with its progress on the terminal, and its truth as JSON, if `truth_path` is not "".
Status WritePressLog(const PressOptions& options, const std::string& path, const std::string& truth_path);

/// The logs that the page offers to somebody who has none: presses with a hidden effect, and a healthy one.
std::vector<ExampleLog> ExamplePressLogs();

}  // namespace hydroscope
