#include <CLI/CLI.hpp>

#include "service/commands.h"
#include "service/output.h"

namespace hydroscope {

void AddFrfCommand(CLI::App&, int&) {}

}  // namespace hydroscope
