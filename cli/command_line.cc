#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "cli/commands.h"

namespace hydroscope {

int RunCommandLine(int argc, const char* const* argv) {
  CLI::App app{
      "Hydroscope: condition monitoring and diagnosis of servo-hydraulic machines by continuous "
      "identification."};
  app.name("hydroscope");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of all commands");
  app.footer(
      "Examples:\n"
      "  hydroscope simulate press --out press.csv --seconds 120 --seed 1\n"
      "  hydroscope fit press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope explain press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope replay press.csv --machine machines/die_cushion.toml --db press.db --report press.html\n"
      "  hydroscope trends --db press.db");
  int exit_code = kDone;
  AddInitCommand(app, exit_code);
  AddCheckCommand(app, exit_code);
  AddSimulateCommand(app, exit_code);
  AddFitCommand(app, exit_code);
  AddCompareCommand(app, exit_code);
  AddExplainCommand(app, exit_code);
  AddModelCommand(app, exit_code);
  AddFrfCommand(app, exit_code);
  AddReplayCommand(app, exit_code);
  AddTrendsCommand(app, exit_code);
  AddServeCommand(app, exit_code);
  AddStatusCommand(app, exit_code);
  AddVerifyLiveCommand(app, exit_code);
  AddAlarmsCommand(app, exit_code);
  AddLearnCommand(app, exit_code);
  AddBenchmarkCommand(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kWrongUse;
  } catch (const std::exception& error) {
    std::cerr << "hydroscope: internal error: " << error.what() << "\n";
    return kOwnFault;
  }
  return exit_code;
}

}  // namespace hydroscope
