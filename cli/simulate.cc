#include <CLI/CLI.hpp>

#include "cli/commands.h"
#include "cli/machines/machines.h"
#include "cli/simulate_log.h"

namespace hydroscope {

void AddSimulateCommand(CLI::App& app, int& exit_code) {
  CLI::App* simulate = app.add_subcommand("simulate", "Logs of simulated machines whose truth is known");
  simulate->require_subcommand(1);
  AddSimulatePress(*simulate, exit_code);
  AddSimulateValve(*simulate, exit_code);
  AddSimulateLog(*simulate, exit_code);
#define HYDROSCOPE_ADD_SIMULATION(Name) AddSimulate##Name(*simulate, exit_code);
  HYDROSCOPE_SIMULATED_MACHINES(HYDROSCOPE_ADD_SIMULATION)
#undef HYDROSCOPE_ADD_SIMULATION
}

}  // namespace hydroscope
