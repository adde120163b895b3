#include "cli/help_formatter.h"

#include <sstream>

#include "host/wrapped_text.h"

namespace hydroscope {
namespace {

constexpr std::size_t kLeastDescription = 24;  // characters, on a terminal narrower than the column of names

/// An example too long for a line goes on in the next one, as a shell reads it: broken before its options alone, since what is
/// quoted may hold blanks.
std::string Continued(std::string line, std::size_t width) {
  constexpr const char* kOn = " \\\n      ";
  std::size_t begin = 0;
  while (line.size() - begin > width) {
    const std::size_t option = line.rfind(" -", begin + width - 2);
    if (option == line.npos || option <= line.find_first_not_of(' ', begin)) break;
    line.replace(option, 1, kOn);
    begin = line.find('\n', option) + 1;
  }
  return line;
}

bool IsHeading(const std::string& line) { return !line.empty() && line.back() == ':'; }

}  // namespace

std::string FilledFooter(const std::string& text, std::size_t width) {
  std::istringstream lines(text);
  std::string filled, before;
  for (std::string line; std::getline(lines, line); before = line) {
    const bool prose = !line.empty() && line.front() != ' ' && !IsHeading(line);
    const bool goes_on = prose && !before.empty() && before.front() != ' ' && !IsHeading(before);
    if (goes_on) filled.back() = ' ';
    filled += (line.starts_with(' ') ? Continued(line, width) : line) + "\n";
  }
  if (!text.ends_with('\n') && !filled.empty()) filled.pop_back();
  return WrappedText(filled, width);
}

std::string HelpFormatter::Described(const std::string& text) const {
  const std::size_t width = width_;
  std::string lines = WrappedText(
      text, width > column_width_ + kLeastDescription ? width - column_width_ : kLeastDescription);
  constexpr char kContinued[] = "\n    ";  // of WrappedText; here the column tells that
  for (std::size_t at = 0; (at = lines.find(kContinued, at)) != std::string::npos; ++at)
    lines.replace(at, sizeof(kContinued) - 1, "\n");
  return lines;
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return WrappedText(CLI::Formatter::make_description(app), width_);
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  return FilledFooter(CLI::Formatter::make_footer(app), width_);
}

std::string HelpFormatter::make_expanded(const CLI::App* command) const {
  constexpr std::size_t kFurtherIn = 2;
  width_ -= kFurtherIn;
  const std::string text = CLI::Formatter::make_expanded(command);
  width_ += kFurtherIn;
  return text;
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  std::string text = CLI::Formatter::make_option_opts(option);
  if (const std::size_t list = text.find(":{"); list != text.npos && text.size() + column_width_ > width_)
    text.resize(list);  // its description tells them
  return text;
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  std::ostringstream out;
  CLI::detail::format_help(out, command->get_name(), Described(command->get_description()), column_width_);
  return out.str();
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  return Described(CLI::Formatter::make_option_desc(option));
}

}  // namespace hydroscope
