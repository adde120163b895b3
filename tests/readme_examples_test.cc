// Runs what README.md and docs/ show behind a "$" and compares what it prints; of all other command lines in them, that
// the program knows their commands and options.

#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;

/// A command and the lines shown under it.
struct Shown {
  std::string command, output;
};

std::string WithoutIndent(const std::string& line) {
  return line.substr(std::min(line.find_first_not_of(' '), line.size()));
}

std::size_t IndentOf(const std::string& line) { return std::min(line.find_first_not_of(' '), line.size()); }

/// Of a page, in order: indented "$ command", then its output, indented as far, up to the next command or text.
std::vector<Shown> ShownIn(const std::string& page) {
  std::vector<Shown> out;
  std::istringstream lines(page);
  std::size_t indent = 0;  // 0: not below a command
  for (std::string line; std::getline(lines, line);) {
    if (IndentOf(line) >= 4 && WithoutIndent(line).starts_with("$ ")) {
      indent = IndentOf(line);
      out.push_back({WithoutIndent(line).substr(2), ""});
    } else if (indent > 0 && (line.empty() || IndentOf(line) >= indent)) {
      out.back().output += (line.empty() ? "" : line.substr(indent)) + "\n";
    } else {
      indent = 0;
    }
  }
  return out;
}

/// Command lines of a page without the program's name: indented ones, and those in the text between backquotes.
std::vector<std::string> CommandsIn(const std::string& page) {
  std::vector<std::string> out;
  std::istringstream lines(page);
  std::string text;  // of the page without indented lines
  for (std::string line; std::getline(lines, line);) {
    if (IndentOf(line) < 4)
      text += line + " ";
    else if (WithoutIndent(line).starts_with("hydroscope "))
      out.push_back(WithoutIndent(line).substr(11));
  }
  for (std::size_t at = text.find('`'); at != text.npos;) {
    const std::size_t end = std::min(text.find('`', at + 1), text.size());
    const std::string code = text.substr(at + 1, end - at - 1);
    if (code.starts_with("hydroscope ")) out.push_back(code.substr(11));
    at = text.find('`', end + 1);
  }
  return out;
}

/// Without blanks at the ends of lines and empty lines at the end.
std::string Trimmed(const std::string& text) {
  std::istringstream lines(text);
  std::string out, empty;
  for (std::string line; std::getline(lines, line);) {
    line.erase(line.find_last_not_of(' ') + 1);
    if (line.empty()) {
      empty += "\n";
      continue;
    }
    out += empty + line + "\n";
    empty.clear();
  }
  return out;
}

/// README.md and the pages of docs/.
std::vector<std::filesystem::path> Pages() {
  const std::filesystem::path source = HYDROSCOPE_SOURCE_DIR;
  std::vector<std::filesystem::path> pages = {source / "README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(source / "docs"))
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  std::sort(pages.begin(), pages.end());
  return pages;
}

class Examples : public CommandLine {
 protected:
  /// The help of every command, by its path: "alarms ack".
  const std::map<std::string, std::string>& Helps() {
    if (helps_.empty()) AddHelps("");
    return helps_;
  }

 private:
  void AddHelps(const std::string& path) {
    std::istringstream words(path);
    std::vector<std::string> call;
    for (std::string word; words >> word;) call.push_back(word);
    call.push_back("--help");
    const std::string help = helps_[path] = Run(call).out;
    const std::size_t at = help.find("Subcommands:\n");
    if (at == std::string::npos) return;
    std::istringstream lines(help.substr(at + 13));
    for (std::string line; std::getline(lines, line) && line.starts_with("  ");) {
      if (IndentOf(line) > 2) continue;  // goes on from the line before
      std::istringstream first(line);
      std::string name;
      first >> name;
      AddHelps(path.empty() ? name : path + " " + name);
    }
  }
  std::map<std::string, std::string> helps_;
};

TEST_F(Examples, OfReadmeAndDocsPrintWhatIsShown) {
  const std::filesystem::path source = HYDROSCOPE_SOURCE_DIR;
  const std::string path = std::filesystem::path(HYDROSCOPE_BINARY).parent_path();
  const char* set = std::getenv("HYDROSCOPE_DATA");  // measured data that studies read
  const std::string data = set != nullptr ? set : source.string() + "/../shared/data";
  std::set<std::string> pages_run;
  for (const std::filesystem::path& page : Pages()) {
    const std::string folder = File(page.stem());  // one for each page: its examples build on one another
    std::filesystem::create_directory(folder);
    std::filesystem::create_directory_symlink(source / "machines", folder + "/machines");
    for (const Shown& shown : ShownIn(ReadText(page))) {
      if (shown.command.starts_with("hydroscope benchmark") && !std::filesystem::exists(data)) continue;
      pages_run.insert(page.stem());
      const std::string line = "cd " + folder + " && unset COLUMNS; export HYDROSCOPE_DATA=" + data +
                               "; PATH=" + path + ":$PATH; " + shown.command + " > shown.txt 2> said.txt";
      WriteText(folder + "/run.sh", line + "\n");
      EXPECT_EQ(std::system(("bash " + folder + "/run.sh").c_str()), 0)
          << page << ": " << shown.command << "\n"
          << ReadText(folder + "/said.txt");
      if (Trimmed(shown.output).empty()) continue;
      EXPECT_EQ(Trimmed(ReadText(folder + "/shown.txt")), Trimmed(shown.output))
          << page << ": " << shown.command;
    }
  }
  EXPECT_GE(pages_run.size(), 2u);
}

TEST_F(Examples, OfReadmeAndDocsNameCommandsAndOptionsThatExist) {
  int looked_at = 0;
  for (const std::filesystem::path& page : Pages()) {
    for (const std::string& text : CommandsIn(ReadText(page))) {
      ++looked_at;
      std::istringstream words(text.substr(0, text.find_first_of("#|;>")));
      std::string path;
      for (std::string word; words >> word;) {
        word.erase(std::remove_if(word.begin(), word.end(), [](char c) { return c == '[' || c == ']'; }),
                   word.end());
        const std::string deeper = path.empty() ? word : path + " " + word;
        if (Helps().contains(deeper)) path = deeper;
        EXPECT_FALSE(path.empty() && !word.starts_with("-")) << page << ": no command in: " << text;
        if (!word.starts_with("--")) continue;
        const std::string option = word.substr(0, word.find_first_of("=,"));
        EXPECT_TRUE(Helps().at(path).find(option) != std::string::npos || option == "--help-all")
            << page << ": '" << path << "' has no " << option << ": " << text;
      }
    }
  }
  EXPECT_GT(looked_at, 100);
}

}  // namespace
}  // namespace hydroscope
