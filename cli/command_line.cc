#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>

#include "cli/commands.h"
#include "cli/help_formatter.h"
#include "core/units.h"

namespace hydroscope {
namespace {

std::vector<std::string> CommandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> OptionsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

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

/// Whether the word behind it is its value.
bool TakesAValue(const CLI::App& app, const std::string& word) {
  if (!word.starts_with("-") || word.find('=') != std::string::npos) return false;
  const CLI::Option* option = app.get_option_no_throw(word);
  return option != nullptr && option->get_type_size() > 0;
}

/// What in the words nobody knows, and what comes nearest; "" if every command and option is known.
std::string UnknownWord(const CLI::App& app, int argc, const char* const* argv) {
  const CLI::App* at = &app;
  const auto sentence = [](const std::string& what, const std::string& word,
                           const std::vector<std::string>& known) {
    const std::string near = Nearest(word, known);
    return fmt::format("unknown {} '{}'{}", what, word,
                       near.empty() ? "" : fmt::format("; did you mean '{}'?", near));
  };
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--") break;
    const std::vector<std::string> commands = CommandsOf(*at);
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      const std::vector<std::string> options = OptionsOf(*at);
      if (std::find(options.begin(), options.end(), name) == options.end())
        return sentence("option", name, options);
    } else if (std::find(commands.begin(), commands.end(), word) != commands.end()) {
      at = at->get_subcommand(word);
    } else if (!commands.empty() && !word.starts_with("-") && !TakesAValue(*at, argv[k - 1])) {
      return sentence(at == &app ? "command" : at->get_name() + " command", word, commands);
    }
  }
  return "";
}

}  // namespace

int RunCommandLine(int argc, const char* const* argv) {
  CLI::App app{
      "Hydroscope: condition monitoring and diagnosis of servo-hydraulic "
      "machines by continuous identification."};
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
  int exit_code = kDone;
#define HYDROSCOPE_ADD_COMMAND(Name) Add##Name##Command(app, exit_code);
  HYDROSCOPE_COMMANDS(HYDROSCOPE_ADD_COMMAND)
#undef HYDROSCOPE_ADD_COMMAND
  AddShellCommands(app, exit_code);
  AddQuiet(app);
  HideEmptyDefaults(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (const std::string unknown = UnknownWord(app, argc, argv);
        error.get_exit_code() != 0 && !unknown.empty()) {
      std::cerr << "hydroscope: " << unknown << "\nRun with --help for more information.\n";
      return kWrongUse;
    }
    return app.exit(error) == 0 ? kDone : kWrongUse;
  } catch (const std::exception& error) {
    std::cerr << "hydroscope: internal error: " << error.what() << "\n";
    return kOwnFault;
  }
  return exit_code;
}

}  // namespace hydroscope
