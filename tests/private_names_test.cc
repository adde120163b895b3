// Sources of a library are compiled together (CMAKE_UNITY_BUILD), and there a function of an anonymous namespace is an overload
// that calls of every other source see. One that takes a call meant for a declared function changes results without a word.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Text by path below the root.
using Sources = std::map<std::string, std::string>;

std::string RoomOf(const std::string& path) { return path.substr(0, path.find('/')); }

/// Names of functions that begin a line of `text`.
std::set<std::string> FunctionsOf(const std::string& text) {
  static const std::regex kFunction(R"((?:^|\n)[A-Za-z_][\w:<>,&* ]*[ &*]([A-Z]\w+)\()");
  std::set<std::string> names;
  for (std::sregex_iterator at(text.begin(), text.end(), kFunction), end; at != end; ++at)
    names.insert((*at)[1]);
  return names;
}

/// What stands in anonymous namespaces.
std::string PrivateText(const std::string& text) {
  const std::string begin = "\nnamespace {\n", end = "\n}  // namespace\n";
  std::string found;
  for (std::size_t at = text.find(begin); at != text.npos;) {
    const std::size_t last = std::min(text.find(end, at), text.size());
    found += text.substr(at + begin.size() - 1, last - at);
    at = text.find(begin, last);
  }
  return found;
}

/// Whether `text` calls a free function of that name.
bool Calls(const std::string& text, const std::string& name) {
  for (std::size_t at = text.find(name + "("); at != text.npos; at = text.find(name + "(", at + 1)) {
    const char before = at == 0 ? '\n' : text[at - 1];
    if (std::isalnum(static_cast<unsigned char>(before)) == 0 &&
        std::string("_:.>").find(before) == std::string::npos)
      return true;
  }
  return false;
}

/// Private functions with the name of a declared one that another source of their room calls, one sentence each.
std::vector<std::string> Faults(const Sources& sources) {
  std::set<std::string> declared;
  std::map<std::string, std::set<std::string>> own;  // by path
  for (const auto& [path, text] : sources)
    if (path.ends_with(".h"))
      declared.merge(FunctionsOf(text));
    else
      own[path] = FunctionsOf(PrivateText(text));
  std::vector<std::string> faults;
  for (const auto& [path, names] : own)
    for (const std::string& name : names)
      for (const auto& [other, theirs] : own)
        if (declared.contains(name) && other != path && RoomOf(other) == RoomOf(path) &&
            !theirs.contains(name) && Calls(sources.at(other), name))
          faults.push_back(
              fmt::format("{} of {} may take calls of {}: give it another name", name, path, other));
  return faults;
}

TEST(PrivateNames, NoneMayTakeTheCallsOfAnotherSource) {
  const std::filesystem::path root = HYDROSCOPE_SOURCE_DIR;
  Sources sources;
  for (const auto& room : std::filesystem::directory_iterator(root)) {
    if (!std::filesystem::exists(room.path() / "CMakeLists.txt") || room.path().filename() == "build")
      continue;
    if (room.path().filename() == "bench" || room.path().filename() == "tests")
      continue;  // programs of one source
    for (const auto& entry : std::filesystem::recursive_directory_iterator(room.path())) {
      const std::string name = entry.path().filename();
      if (!name.ends_with(".h") && !name.ends_with(".cc")) continue;
      if (name.ends_with("_test.cc") || name.ends_with("_fuzz.cc") || name.ends_with("_fixture.h")) continue;
      std::ifstream in(entry.path());
      sources[std::filesystem::relative(entry.path(), root)] = {std::istreambuf_iterator<char>(in), {}};
    }
  }
  EXPECT_GT(sources.size(), 1000u) << "the source tree was not found";
  EXPECT_THAT(Faults(sources), IsEmpty());
}

TEST(PrivateNames, OneThatTakesACallIsFound) {
  const Sources sources = {
      {"models/output_unit.h",
       "#pragma once\nstd::string_view SiOf(const Machine& machine, std::string_view name);\n"},
      {"workbench/model.cc",
       "\nnamespace {\n\nstd::string SiOf(const Machine& m, const std::string& n) {\n}\n\n}  // namespace\n"},
      {"workbench/location.cc", "unit = SiOf(machine, name);\n"},
      {"page/picture.cc", "unit = SiOf(machine, name);\n"}};
  EXPECT_THAT(
      Faults(sources),
      ElementsAre(
          "SiOf of workbench/model.cc may take calls of workbench/location.cc: give it another name"));
}

}  // namespace
}  // namespace hydroscope
