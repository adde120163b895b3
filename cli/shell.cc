#include <CLI/CLI.hpp>
#include <iostream>

#include "cli/commands.h"
#include "cli/help_formatter.h"

namespace hydroscope {
namespace {

std::vector<const CLI::App*> CommandsUnder(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// "--json", "-m": every name of every option, with those of a command above that may stand behind this one too.
std::vector<std::string> OptionNames(const CLI::App& app) {
  std::vector<std::string> names;
  if (const CLI::App* above = app.get_parent(); above != nullptr && app.get_fallthrough())
    names = OptionNames(*above);
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// "hydroscope alarms ack" -> "alarms ack"; "" is the program itself.
std::string PathOf(const CLI::App& app) {
  if (app.get_parent() == nullptr) return "";
  const std::string above = PathOf(*app.get_parent());
  return above.empty() ? app.get_name() : above + " " + app.get_name();
}

template <typename Visit>
void ForEachCommand(const CLI::App& app, Visit visit) {
  visit(app);
  for (const CLI::App* command : CommandsUnder(app)) ForEachCommand(*command, visit);
}

/// A case of the shell: the words that may follow a command.
std::string CasesOf(const CLI::App& app) {
  std::string cases;
  ForEachCommand(app, [&](const CLI::App& command) {
    std::vector<std::string> words;
    for (const CLI::App* under : CommandsUnder(command)) words.push_back(under->get_name());
    const auto options = OptionNames(command);
    words.insert(words.end(), options.begin(), options.end());
    cases += fmt::format("    \"{}\") list=\"{}\" ;;\n", PathOf(command), fmt::join(words, " "));
  });
  return cases;
}

/// All paths of commands, so that the shell finds the one being written.
std::string PathsOf(const CLI::App& app) {
  std::string paths;
  ForEachCommand(app, [&](const CLI::App& command) {
    if (command.get_parent() != nullptr) paths += "|" + PathOf(command);
  });
  return paths + "|";
}

constexpr std::size_t kManualWidth = 72;  // characters, beside the margin of a manual page
constexpr const char* kBash =
    R"sh(# bash completion for hydroscope: eval "$(hydroscope completion bash)"
_hydroscope() {
  local word=${COMP_WORDS[COMP_CWORD]} path= list= k next
  local known=)sh";
constexpr const char* kBashRest = R"sh(
  for ((k = 1; k < COMP_CWORD; ++k)); do
    next=${path:+$path }${COMP_WORDS[k]}
    [[ $known == *"|$next|"* ]] && path=$next
  done
  case "$path" in
)sh";
constexpr const char* kBashEnd = R"sh(  esac
  COMPREPLY=($(compgen -W "$list" -- "$word"))
  [[ $word == -* ]] || COMPREPLY+=($(compgen -f -- "$word"))
}
complete -o filenames -F _hydroscope hydroscope
)sh";

std::string BashCompletion(const CLI::App& app) {
  return fmt::format("{}'{}'{}{}{}", kBash, PathsOf(app), kBashRest, CasesOf(app), kBashEnd);
}

constexpr const char* kZsh = R"sh(#compdef hydroscope
# zsh completion for hydroscope: eval "$(hydroscope completion zsh)", or as _hydroscope in a folder of $fpath
_hydroscope() {
  local path_= list= next k
  local known=)sh";
constexpr const char* kZshRest = R"sh(
  for ((k = 2; k < CURRENT; ++k)); do
    next=${path_:+$path_ }${words[k]}
    [[ $known == *"|$next|"* ]] && path_=$next
  done
  case "$path_" in
)sh";
constexpr const char* kZshEnd = R"sh(  esac
  compadd -- ${=list}
  _files
}
if [[ ${funcstack[1]} == _hydroscope ]]; then  # called as a file of $fpath
  _hydroscope "$@"
else
  compdef _hydroscope hydroscope
fi
)sh";

std::string ZshCompletion(const CLI::App& app) {
  return fmt::format("{}'{}'{}{}{}", kZsh, PathsOf(app), kZshRest, CasesOf(app), kZshEnd);
}

/// Text safe in a manual page: no line begins a request, backslashes and hyphens are meant.
std::string Roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    line_begins = c == '\n';
    out += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return out;
}

std::string OptionRoff(const CLI::Option& option) {
  const std::string type = option.get_type_size() == 0 ? "" : " " + option.get_type_name();
  const std::string name =
      option.get_positional() ? option.get_name(true) : option.get_name(false, true) + type;
  return ".TP\n\\fB" + Roff(name) + "\\fR\n" + Roff(option.get_description()) + "\n";
}

/// Every command with its options and what its help says below them.
std::string Manual(const CLI::App& app, const std::string& version) {
  std::string text =
      ".TH HYDROSCOPE 1 \"\" \"hydroscope " + version +
      "\"\n.SH NAME\nhydroscope \\- condition monitoring and diagnosis of servo\\-hydraulic machines\n"
      ".SH SYNOPSIS\n.B hydroscope\nCOMMAND [ARGUMENT]... [OPTION]...\n.SH DESCRIPTION\n" +
      Roff(app.get_description()) + "\n";
  ForEachCommand(app, [&](const CLI::App& command) {
    text += command.get_parent() == nullptr
                ? ".SH OPTIONS\n"
                : ".SH HYDROSCOPE " + Roff(PathOf(command)) + "\n" + Roff(command.get_description()) + "\n";
    for (const CLI::Option* option : command.get_options())
      if (!option->get_group().empty()) text += OptionRoff(*option);
    if (!command.get_footer().empty())
      text += ".PP\n.nf\n" + Roff(FilledFooter(command.get_footer(), kManualWidth)) + "\n.fi\n";
  });
  return text +
         ".SH EXIT STATUS\n0 done, 1 a fault of the program, 2 wrong use, 3 bad input, 4 partly done\n";
}

}  // namespace

void AddShellCommands(CLI::App& app, int& exit_code) {
  auto shell = std::make_shared<std::string>();
  CLI::App* completion =
      app.add_subcommand("completion", "Completion of commands and options for the shell, on stdout");
  completion->add_option("SHELL", *shell, "bash or zsh")->required()->check(CLI::IsMember({"bash", "zsh"}));
  completion->footer(
      "Examples:\n"
      "  eval \"$(hydroscope completion bash)\"\n"
      "  hydroscope completion zsh > ~/.zfunc/_hydroscope");
  completion->callback([shell, &app, &exit_code] {
    std::cout << (*shell == "bash" ? BashCompletion(app) : ZshCompletion(app));
    exit_code = kDone;
  });
  app.add_subcommand("manual", "This help as a manual page, on stdout: hydroscope manual | man -l -")
      ->callback([&app, &exit_code] {
        std::cout << Manual(app, HYDROSCOPE_VERSION);
        exit_code = kDone;
      });
}

}  // namespace hydroscope
