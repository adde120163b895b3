#include <CLI/CLI.hpp>

#include "service/commands.h"
#include "service/output.h"

namespace hydroscope {

void AddSimulateCommand(CLI::App&, int&) {}

}  // namespace hydroscope
