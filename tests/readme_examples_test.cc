// Runs what README.md shows behind a "$" and compares what it prints.

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;

/// A command and the lines shown under it.
struct Shown {
  std::string command, output;
};

/// Of a page, in order: "    $ command", then its indented output up to the next command or text.
std::vector<Shown> ShownIn(const std::string& page) {
  std::vector<Shown> out;
  std::istringstream lines(page);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("    $ ")) {
      out.push_back({line.substr(6), ""});
      inside = true;
    } else if (inside && (line.empty() || line.starts_with("    "))) {
      out.back().output += (line.empty() ? "" : line.substr(4)) + "\n";
    } else {
      inside = false;
    }
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

class Examples : public CommandLine {};

TEST_F(Examples, OfTheReadmePrintWhatItShows) {
  const std::filesystem::path source = HYDROSCOPE_SOURCE_DIR;
  std::filesystem::create_directory_symlink(source / "machines", File("machines"));
  const std::string path = std::filesystem::path(HYDROSCOPE_BINARY).parent_path();
  int run = 0;
  for (const Shown& shown : ShownIn(ReadText(source / "README.md"))) {
    ++run;
    const std::string line =
        "cd " + File("") + " && PATH=" + path + ":$PATH; " + shown.command + " > shown.txt 2> /dev/null";
    EXPECT_EQ(std::system(line.c_str()), 0) << shown.command;
    if (Trimmed(shown.output).empty()) continue;
    EXPECT_EQ(Trimmed(ReadText(File("shown.txt"))), Trimmed(shown.output)) << shown.command;
  }
  EXPECT_GE(run, 2);
}

}  // namespace
}  // namespace hydroscope
