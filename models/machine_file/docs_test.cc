#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "core/units.h"
#include "models/machine.h"
#include "models/machine_file/keys.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

std::string ReadPage() {
  std::ifstream file(std::string(HYDROSCOPE_SOURCE_DIR) + "/docs/machine_file.md");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The page from `heading` to the next heading of the same kind.
std::string Chapter(const std::string& page, const std::string& heading) {
  const std::size_t begin = page.find("\n## " + heading);
  if (begin == std::string::npos) return "";
  return page.substr(begin, page.find("\n## ", begin + 1) - begin);
}

/// The chapter that describes the keys of a section of the parser.
const std::map<std::string, std::string> kChapters = {
    {"machine", "`[machine]`"},
    {"log", "`[log]`"},
    {"log.time", "`[log]`"},
    {"signals.<name>", "`[signals]`"},
    {"geometry.<name>", "`[geometry]`"},
    {"gate", "`[gate]`"},
    {"gate.conditions.<signal>", "`[gate]`"},
    {"window", "`[window]`"},
    {"estimator", "`[estimator]`"},
    {"monitor.<parameter>", "`[monitor.<parameter>]`"},
    {"valve", "`[valve]`"},
    {"experiment", "`[experiment]`"},
    {"experiment.<range>", "`[experiment]`"},
    {"balance", "`[balance]` and `[[effect]]`"},
    {"effect", "`[balance]` and `[[effect]]`"},
    {"shape.<name>", "`[balance]` and `[[effect]]`"},
    {"states.<name>", "`[states]`"},
    {"parameters.<name>", "`[states]`"},
    {"episodes", "`[episodes]`"},
    {"terms.<parameter>", "`[balance]` and `[[effect]]`"},
    {"live", "`[live]`"},
    {"feeds", "`[feeds]`"},
    {"model_history", "`[[model_history]]`"},
    {"model_history.parameters.<name>", "`[[model_history]]`"},
    {"<quantity>", "Rules for all sections"}};

TEST(MachineFilePage, DescribesEveryKeyInTheChapterOfItsSection) {
  const std::string page = ReadPage();
  for (const MachineSection& section : MachineFileSections()) {
    if (section.name.empty()) continue;
    std::string known = section.name;
    if (known.starts_with("feeds.")) known = "feeds";
    if (known.starts_with("live.") || known.starts_with("signals.<name>.")) known = "live";
    const auto heading = kChapters.find(known);
    ASSERT_NE(heading, kChapters.end()) << "no chapter for section " << section.name;
    const std::string chapter = Chapter(page, heading->second);
    ASSERT_FALSE(chapter.empty()) << "chapter " << heading->second << " is missing";
    for (const std::string& key : section.keys)
      EXPECT_NE(chapter.find("`" + key + "`"), std::string::npos)
          << section.name << ": " << key << " is not described";
  }
}

TEST(MachineFilePage, DescribesEverySectionModelAndInput) {
  const std::string page = ReadPage();
  for (const std::string& section : MachineFileKeys(""))
    EXPECT_NE(page.find("[" + section), std::string::npos) << section;
  for (const std::string& model : KindNames()) {
    EXPECT_NE(page.find("`\"" + model + "\"`"), std::string::npos) << model;
    for (const auto& inputs : {FindKind(model)->signals, FindKind(model)->geometry})
      for (const MachineInput& input : inputs)
        EXPECT_NE(page.find("| `" + std::string(input.name) + "` | " + std::string(input.si)),
                  std::string::npos)
            << model << ": " << input.name;
  }
}

TEST(MachineFilePage, NamesEveryUnit) {
  std::string rules = Chapter(ReadPage(), "Rules for all sections");
  for (char& c : rules)
    if (c == '`' || c == '\n' || c == ',') c = ' ';
  for (const std::string& unit : UnitNames())
    EXPECT_NE(rules.find(" " + unit + " "), std::string::npos) << unit;
}

/// Every indented block of the page is a piece of a machine file; each must be valid where it stands: pieces
/// of a die cushion are completed by the first example.
TEST(MachineFilePage, ShowsExamplesThatLoad) {
  const std::string page = ReadPage();
  std::istringstream lines(page);
  std::vector<std::string> examples(1);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("    "))
      examples.back() += line.substr(4) + "\n";
    else if (!line.empty() && !examples.back().empty())
      examples.emplace_back();
  }
  if (examples.back().empty()) examples.pop_back();
  ASSERT_GE(examples.size(), 9u);
  const auto whole = ParseMachine(examples.front(), "first example");
  ASSERT_TRUE(whole) << whole.error().text;
  for (const std::string& example : examples) {
    std::string text = example;
    const bool own =
        example.find("[balance]") != std::string::npos || example.find("[states]") != std::string::npos;
    if (example.find("header = false") != std::string::npos)
      text += "[signals]\np_A = { column = 2, unit = \"Pa\" }\nz = { column = 3, unit = \"m\" }\ny_v = 4\n";
    else if (!own && example.find("[signals]") == std::string::npos)
      text +=
          "[signals]\np_A = { column = \"p\", unit = \"Pa\" }\nz = { column = \"z\", unit = \"m\" }\ny_v = \"y\"\n"
          "U_v = { column = \"U\", unit = \"V\" }\n";
    else if (!own && example.find("y_v = ") == std::string::npos)
      text += "z = { column = \"z\", unit = \"m\" }\ny_v = \"y\"\n";
    if (!own && example.find("[geometry]") == std::string::npos)
      text += "[geometry]\nA_A = 0.01\ndp_nom = 35e5\n";
    const auto machine = ParseMachine(text, "example");
    EXPECT_TRUE(machine) << machine.error().text << "\n" << text;
  }
}

}  // namespace
}  // namespace hydroscope
