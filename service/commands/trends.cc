#include <CLI/CLI.hpp>

#include "service/commands.h"
#include "service/output.h"

namespace hydroscope {

void AddTrendsCommand(CLI::App&, int&) {}

}  // namespace hydroscope
