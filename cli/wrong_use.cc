#include "cli/wrong_use.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include "core/contains.h"
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
std::string Explained(const CLI::App& command, const CLI::ParseError& error) {
  const std::string message = error.what();
  const CLI::Option* option = OptionIn(command, message);
  if (option == nullptr) return message;
  const std::string name = option->get_positional() ? option->get_name() : option->get_name(false, false);
  switch (static_cast<CLI::ExitCodes>(error.get_exit_code())) {
    case CLI::ExitCodes::RequiredError:
      return fmt::format("{} is missing: {}{}", name, option->get_description(),
                         name == "--machine" ? "; `hydroscope init LOG --out press.toml` proposes one" : "");
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

}  // namespace

std::string WrongUse(const CLI::App& app, int argc, const char* const* argv, const CLI::ParseError& error) {
  const CLI::App& command = CommandCalled(app);
  const std::string name = FullName(command), unknown = UnknownWord(app, argc, argv);
  return fmt::format("{}\n`hydroscope {}{}--help` shows how it is called.",
                     unknown.empty() ? Explained(command, error) : unknown, name, name.empty() ? "" : " ");
}

}  // namespace hydroscope
