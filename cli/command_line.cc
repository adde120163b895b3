#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/help_formatter.h"
#include "cli/plain_numbers.h"
#include "core/contains.h"
#include "core/units.h"
#include "host/output.h"

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
      if (!Contains(options, name)) return sentence("option", name, options);
    } else if (Contains(commands, word)) {
      at = at->get_subcommand(word);
    } else if (!commands.empty() && !word.starts_with("-") && !TakesAValue(*at, argv[k - 1])) {
      return sentence(at == &app ? "command" : at->get_name() + " command", word, commands);
    }
  }
  return "";
}

/// The command that the words lead to.
const CLI::App& CommandCalled(const CLI::App& app) {
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? app : CommandCalled(*parsed.back());
}

/// "fit", "alarms shelve"; "" of the program itself.
std::string FullName(const CLI::App& command) {
  if (command.get_parent() == nullptr) return "";
  const std::string above = FullName(*command.get_parent());
  return above.empty() ? command.get_name() : above + " " + command.get_name();
}

/// "a whole number from 0 to 65535" for what a limit calls itself: "INT in [0 - 65535]", "POSITIVE", "{bash,zsh}".
std::string Expected(std::string limit) {
  const bool whole = limit.find("INT") != std::string::npos;
  if (limit.find("POSITIVE") != std::string::npos)
    return whole ? "a whole number above 0" : "a number above 0";
  if (limit.find("NONNEGATIVE") != std::string::npos) return "0 or a positive number";
  if (const auto in = limit.find(" in ["); in != std::string::npos) {
    limit = limit.substr(in + 5, limit.size() - in - 6);
    if (const auto to = limit.find(" - "); to != std::string::npos) limit.replace(to, 3, " to ");
    return fmt::format("a {} from {}", whole ? "whole number" : "number", limit);
  }
  if (const auto list = limit.find('{'); list != std::string::npos) {
    limit = limit.substr(list + 1, limit.find('}') - list - 1);
    for (std::size_t comma = 0; (comma = limit.find(',', comma)) != std::string::npos; comma += 2)
      limit.replace(comma, 1, ", ");
    if (const auto last = limit.rfind(", "); last != std::string::npos) limit.replace(last, 2, " or ");
    return limit;
  }
  if (whole) return "a whole number";
  return limit.find("FLOAT") != std::string::npos ? "a number" : "another value";
}

/// The option or argument of `command` that the parser's message begins with or holds.
const CLI::Option* OptionIn(const CLI::App& command, const std::string& message) {
  const CLI::Option* found = nullptr;
  std::size_t longest = 0;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (message.find(name) == std::string::npos || name.size() <= longest) continue;
    found = option;
    longest = name.size();
  }
  return found;
}

bool IsWhole(const std::string& number) {
  const std::size_t digits = number.starts_with('-') ? 1 : 0;
  return number.size() > digits && std::all_of(number.begin() + digits, number.end(),
                                               [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// "--port 99999: expected a whole number from 0 to 65535", or the parser's own words where nothing better is known.
std::string InPlainWords(const CLI::App& command, const CLI::ParseError& error) {
  const std::string message = error.what();
  const CLI::Option* option = OptionIn(command, message);
  if (option == nullptr) return message;
  const std::string name = option->get_positional() ? option->get_name() : option->get_name(false, false);
  switch (static_cast<CLI::ExitCodes>(error.get_exit_code())) {
    case CLI::ExitCodes::RequiredError:
      return fmt::format("{} is missing: {}", name, option->get_description());
    case CLI::ExitCodes::ArgumentMismatch:
      return name + ": its value is missing";
    case CLI::ExitCodes::ConversionError:
    case CLI::ExitCodes::ValidationError: {
      const auto& given = option->results();
      const std::string type = option->get_type_name();
      if (const bool alone = type == "INT" || type == "UINT";
          alone && !given.empty() && IsWhole(given.back()))
        return fmt::format("{} {}: expected a {} number", name, given.back(),
                           given.back().front() == '-' ? "larger" : "smaller");
      return fmt::format("{}{}{}: expected {}", name, given.empty() ? "" : " ",
                         given.empty()          ? ""
                         : given.back().empty() ? "''"
                                                : given.back(),
                         Expected(type));
    }
    default:
      return message;
  }
}

/// What is wrong with the words of a command line that `app` refused with `error`: an unknown command or option and the one
/// that comes nearest, a value and what was expected in its place, what is missing; and which help tells more.
std::string WrongUse(const CLI::App& app, int argc, const char* const* argv, const CLI::ParseError& error) {
  const CLI::App& command = CommandCalled(app);
  const std::string name = FullName(command), unknown = UnknownWord(app, argc, argv);
  return fmt::format("{}\n`hydroscope {}{}--help` shows how it is called.",
                     unknown.empty() ? InPlainWords(command, error) : unknown, name, name.empty() ? "" : " ");
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
