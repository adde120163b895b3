
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "cli/commands.h"
#include "cli/help_formatter.h"
#include "cli/plain_numbers.h"
#include "cli/wrong_use.h"
#include "host/output.h"

namespace hydroscope {
namespace {

/// --quiet for every command that does something.
void AddQuiet(CLI::App& app) {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  for (CLI::App* command : commands) AddQuiet(*command);
  if (app.get_parent() != nullptr)
    app.add_flag_callback("--quiet", BeQuiet, "No text for people on stdout and no progress; errors stay");
}

/// A list without entries is no default that help should tell.
void HideEmptyDefaults(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    HideEmptyDefaults(*command);
  for (CLI::Option* option : app.get_options())
    if (option->get_default_str() == "[]") option->default_str("");
}

}  // namespace

void AddCommands(CLI::App& app, int& exit_code) {
  app.description(
      "Hydroscope: condition monitoring and diagnosis of servo-hydraulic "
      "machines by continuous identification.");
  app.name("hydroscope");
  app.formatter(std::make_shared<HelpFormatter>());  // of its commands too
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Help of all commands");
  app.set_version_flag("--version", "hydroscope " HYDROSCOPE_VERSION, "Print the version and exit");
  app.footer(
      "Examples:\n"
      "  hydroscope simulate press --out press.csv --seconds 120 --seed 1\n"
      "  hydroscope fit press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope explain press.csv --machine machines/die_cushion.toml\n"
      "  hydroscope replay press.csv --machine machines/die_cushion.toml --db press.db --report press.html\n"
      "  hydroscope trends --db press.db");
#define HYDROSCOPE_ADD_COMMAND(Name) Add##Name##Command(app, exit_code);
  HYDROSCOPE_COMMANDS(HYDROSCOPE_ADD_COMMAND)
#undef HYDROSCOPE_ADD_COMMAND
  AddShellCommands(app, exit_code);
  AddQuiet(app);
  HideEmptyDefaults(app);
  TakePlainNumbersOnly(app);
}

int RunCommandLine(int argc, const char* const* argv) {
  CLI::App app;
  int exit_code = kDone;
  AddCommands(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      SayBeside("hydroscope: " + WrongUse(app, argc, argv, error) + "\n");
      return kWrongUse;
    }
    app.exit(error);  // help or version
  } catch (const std::exception& error) {
    std::cerr << "hydroscope: internal error: " << error.what() << "\n";
    return kOwnFault;
  }
  if (const Status written = FinishStandardOutput(); !written) return ReportError(written.error());
  return exit_code;
}

}  // namespace hydroscope
