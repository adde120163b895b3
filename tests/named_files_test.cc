// Files and folders that the documents and the comments of sources name, which must be there.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace hydroscope {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::string TextOf(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Folders with sources, documents or scripts.
std::vector<std::string> Folders() {
  std::vector<std::string> folders = {"docs", "scripts", "web"};
  for (const auto& entry : fs::directory_iterator(HYDROSCOPE_SOURCE_DIR))
    if (fs::exists(entry.path() / "CMakeLists.txt")) folders.push_back(entry.path().filename());
  std::erase(folders, "build");
  return folders;
}

bool IsPartOfPath(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_./@-", c) != nullptr;
}

/// Whether a file, a folder, or a source whose ending is left out has that name.
bool Exists(const std::string& name) {
  const fs::path path = fs::path(HYDROSCOPE_SOURCE_DIR) / name;
  return fs::exists(path) || fs::exists(path.string() + ".cc") || fs::exists(path.string() + ".h");
}

/// What a text names in one of the folders ("models/effect.h", "pipeline/log_pass") and is not there.
std::vector<std::string> Missing(const std::string& text) {
  std::vector<std::string> missing;
  for (const std::string& folder : Folders()) {
    const std::string begin = folder + "/";
    for (std::size_t at = text.find(begin); at != text.npos; at = text.find(begin, at + 1)) {
      if (at > 0 && (IsPartOfPath(text[at - 1]) || text[at - 1] == '~' || text[at - 1] == '$')) continue;
      const auto end = std::find_if_not(text.begin() + static_cast<long>(at), text.end(), IsPartOfPath);
      std::string name(text.begin() + static_cast<long>(at), end);
      while (name.ends_with('.') || name.ends_with('-')) name.pop_back();
      if (end != text.end() && (*end == '*' || *end == '<' || *end == '{')) continue;  // a pattern
      if (!Exists(name)) missing.push_back(name);
    }
  }
  return missing;
}

/// The comments of a source, one line each.
std::string CommentsOf(const std::string& source) {
  std::string comments;
  for (std::size_t at = source.find("// "); at != source.npos; at = source.find("// ", at + 1))
    comments += source.substr(at, source.find('\n', at) - at) + "\n";
  return comments;
}

TEST(NamedFiles, OfReadmeAndDocsAreThere) {
  const fs::path root = HYDROSCOPE_SOURCE_DIR;
  EXPECT_THAT(Missing(TextOf(root / "README.md")), IsEmpty());
  for (const auto& entry : fs::directory_iterator(root / "docs")) {
    if (entry.path().extension() != ".md") continue;
    EXPECT_THAT(Missing(TextOf(entry.path())), IsEmpty()) << entry.path();
  }
}

TEST(NamedFiles, OfCommentsInSourcesAreThere) {
  int files = 0;
  for (const std::string& folder : Folders()) {
    if (folder == "web") continue;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(HYDROSCOPE_SOURCE_DIR) / folder)) {
      const std::string ending = entry.path().extension();
      if (ending != ".cc" && ending != ".h") continue;
      ++files;
      EXPECT_THAT(Missing(CommentsOf(TextOf(entry.path()))), IsEmpty()) << entry.path();
    }
  }
  EXPECT_GT(files, 1000);
}

/// What tests/long_tests.txt leaves out of the everyday run: folder and name of a test.
TEST(NamedFiles, LongTestsAreThere) {
  const fs::path root = HYDROSCOPE_SOURCE_DIR;
  std::ifstream in(root / "tests/long_tests.txt");
  int count = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    ++count;
    const std::size_t space = line.find(' '), dot = line.find('.');
    ASSERT_LT(space, dot) << line;
    const std::string test =
        fmt::format("({}, {}) {{", line.substr(space + 1, dot - space - 1), line.substr(dot + 1));
    const auto files = fs::recursive_directory_iterator(root / line.substr(0, space));
    EXPECT_TRUE(std::any_of(begin(files), end(files), [&](const fs::directory_entry& file) {
      return file.path().string().ends_with("_test.cc") &&
             TextOf(file.path()).find(test) != std::string::npos;
    })) << line;
  }
  EXPECT_GT(count, 10);
}

TEST(NamedFiles, FindsOneThatIsNotThere) {
  EXPECT_THAT(Missing("as models/effect.h and `pipeline/log_pass` say, models/no_such_file.h. web/src."),
              ElementsAre("models/no_such_file.h"));
}

}  // namespace
}  // namespace hydroscope
