#include <CLI/CLI.hpp>

#include "service/commands.h"
#include "service/output.h"

namespace hydroscope {

void AddReplayCommand(CLI::App&, int&) {}

}  // namespace hydroscope
