// The table of docs/architecture.md: who may include whom, and what only one folder may use.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "models/machine_kind.h"

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Folders of the project a folder's own files (tests aside) may include.
const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"core", {}},
    {"dds", {"core"}},
    {"models", {"core"}},
    {"machines", {"core", "models"}},
    {"acquisition", {"core", "models", "dds"}},
    {"estimation", {"core", "models"}},
    {"diagnosis", {"core", "models", "estimation"}},
    {"storage", {"core"}},
    {"alarms", {"core", "models", "storage", "dds"}},
    {"replay", {"core", "models", "acquisition"}},
    {"simulator", {"core", "dds"}},
    {"host", {"core"}},
    {"pipeline", {"core", "models", "acquisition", "estimation", "diagnosis", "storage", "replay", "host"}},
    {"setup", {"core", "models", "replay", "host"}},
    {"workbench", {"core", "models", "estimation", "diagnosis", "storage", "replay", "host", "pipeline"}},
    {"monitor", {"core", "models", "diagnosis", "storage", "alarms", "host", "pipeline", "workbench"}},
    {"report", {"core", "models", "diagnosis", "storage", "host", "pipeline", "workbench", "monitor"}},
    {"review",
     {"core", "models", "estimation", "storage", "replay", "host", "pipeline", "workbench", "monitor",
      "report"}},
    {"page",
     {"core", "models", "estimation", "diagnosis", "storage", "alarms", "replay", "host", "pipeline", "setup",
      "workbench", "monitor", "report"}},
    {"live",
     {"core", "models", "acquisition", "estimation", "storage", "alarms", "host", "pipeline", "monitor"}},
    {"studies",
     {"core", "dds", "models", "acquisition", "estimation", "diagnosis", "storage", "alarms", "replay",
      "simulator", "host", "pipeline", "workbench", "monitor", "report", "review", "live"}},
    {"cli",
     {"core", "models", "acquisition", "estimation", "diagnosis", "storage", "alarms", "replay", "simulator",
      "host", "pipeline", "setup", "workbench", "monitor", "report", "review", "page", "live", "studies"}},
};

/// A word that only files whose path begins with one of `places` may contain.
struct Reserved {
  std::string word;
  std::vector<std::string> places;
};
const std::vector<Reserved> kReservedIncludes = {
    {"<sqlite3.h>", {"storage/"}},
    {"<SQLiteCpp/", {"storage/"}},
    {"<modbus", {"acquisition/modbus/", "simulator/die_cushion/modbus/"}},
    {"<fastdds/", {"dds/", "acquisition/dds/", "alarms/feeds/dds/", "simulator/dds/"}},
    {"<fastrtps/", {"dds/", "acquisition/dds/", "alarms/feeds/dds/", "simulator/dds/"}},
    {"<hydroscope_wire/", {"dds/", "acquisition/dds/", "alarms/feeds/dds/", "simulator/dds/"}},
    {"<mqtt/", {"alarms/feeds/sparkplug/"}},
    {"<google/protobuf/", {"alarms/feeds/sparkplug/"}},
    {"<matio.h>", {"replay/"}},
    {"<sodium.h>", {"page/access/"}},
    {"<CLI/", {"cli/", "workbench/history/history_options"}},
};
const std::vector<Reserved> kReservedWords = {
    {"steady_clock", {"host/", "live/", "studies/", "cli/"}},
    {"system_clock", {"host/", "live/", "studies/", "cli/"}},
    {"high_resolution_clock", {"studies/"}},
    {"clock_gettime", {"studies/", "dds/steady_waits.cc"}},  // which waits in the library's place
    {"std::time(", {}},                                      // coarse: it can be behind the time of a file
    {"file_time_type::clock", {"dds/shared_memory.cc"}},     // age of what killed processes left behind
    {"getenv", {"host/", "cli/", "live/", "studies/"}},
    {"random_device", {"dds/shared_memory.cc"}},  // a port number no process had before
    {"<sys/socket.h>",
     {"live/", "page/", "studies/", "acquisition/modbus/", "alarms/", "simulator/die_cushion/modbus/",
      "dds/participant.cc"}},  // whether a port is free
    {"sleep_for", {"live/", "studies/", "cli/"}},
};

/// Folders that simulate machines, and so name what is theirs.
const std::vector<std::string> kNameAllThings = {"studies/", "cli/machines/"};
/// What a machine is stands in its folder of machines/. Files that name signals, parameters or effects of built-in machines
/// all the same, and why.
const std::map<std::string, std::string> kNameThings = {
    {"setup/column_names.cc", "what logs call the signals of hydraulic machines, whatever the machine"},
    {"models/machine.h", "signals that [valve] means where it names none"},
    {"workbench/frequency_response/valve_output.cc",
     "JSON of a valve's response, whose gain has the name of a pump's spring"},
};

/// Names of all kinds of machines and of their signals, geometry, parameters and effects; of one letter none, which are units
/// too, nor what names a section of every machine file.
const std::set<std::string>& MachineNames() {
  static const std::set<std::string> kNames = [] {
    std::set<std::string> names;
    for (const MachineKind* kind : MachineKinds()) {
      names.emplace(kind->id);
      for (const auto* inputs : {&kind->signals, &kind->geometry})
        for (const MachineInput& input : *inputs) names.emplace(input.name);
      for (const MachineParameter& parameter : kind->parameters) names.emplace(parameter.name);
      if (kind->effects != nullptr)
        for (const auto& effect : kind->effects({})) names.insert(effect->id);
    }
    for (const char* section : {"valve", "states", "stroke"}) names.erase(section);
    std::erase_if(names, [](const std::string& name) { return name.size() < 2; });
    return names;
  }();
  return kNames;
}

/// Texts between quotes in a line of code.
std::vector<std::string> Literals(const std::string& code) {
  std::vector<std::string> literals;
  for (std::size_t at = code.find('"'); at != code.npos;) {
    const std::size_t end = code.find('"', at + 1);
    if (end == code.npos) break;
    literals.push_back(code.substr(at + 1, end - at - 1));
    at = code.find('"', end + 1);
  }
  return literals;
}

/// The first name of a machine in a text between quotes: the whole text, or `inside` it a word that no language has.
std::string MachineNameIn(const std::string& literal, bool inside) {
  if (MachineNames().contains(literal)) return literal;
  if (!inside) return "";
  const auto part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
  for (auto begin = literal.begin(); begin != literal.end();) {
    begin = std::find_if(begin, literal.end(), part);
    const auto end = std::find_if_not(begin, literal.end(), part);
    const std::string word(begin, end);
    if (word.find('_') != word.npos && MachineNames().contains(word)) return word;
    begin = end;
  }
  return "";
}

bool BeginsWithOneOf(const std::string& path, const std::vector<std::string>& places) {
  return std::any_of(places.begin(), places.end(), [&](const std::string& p) { return path.starts_with(p); });
}

/// What the file breaks of the table, one sentence each.
std::vector<std::string> Faults(const std::string& path, const std::string& text) {
  std::vector<std::string> faults;
  const std::string folder = path.substr(0, path.find('/'));
  const auto allowed = kMayInclude.find(folder);
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::string where = fmt::format("{}:{}", path, number);
    if (line.starts_with("#include \"")) {
      const std::string included = line.substr(10, line.find('/') == line.npos ? 0 : line.find('/') - 10);
      if (allowed != kMayInclude.end() && included != folder && !allowed->second.contains(included))
        faults.push_back(
            fmt::format("{}: {}/ may include {}, not {}/", where, folder, allowed->second, included));
    }
    if (line.starts_with("#include"))
      for (const Reserved& r : kReservedIncludes)
        if (line.find(r.word) != line.npos && !BeginsWithOneOf(path, r.places))
          faults.push_back(fmt::format("{}: {} belongs to {}", where, r.word, r.places));
    const std::string code = line.substr(0, line.find("//"));
    const bool apart = path.starts_with("machines/") || path.starts_with("simulator/");
    if (!apart && code.starts_with("#include \"machines/"))
      faults.push_back(fmt::format("{}: only machines/ includes machines/", where));
    const bool names = apart || line.starts_with("#include") || BeginsWithOneOf(path, kNameAllThings) ||
                       kNameThings.contains(path);
    const bool inside = !path.starts_with("cli/");  // whose help has examples of shipped machines
    for (const std::string& literal : Literals(code))
      if (const std::string name = MachineNameIn(literal, inside); !names && !name.empty())
        faults.push_back(fmt::format("{}: \"{}\" of a machine belongs into machines/", where, name));
    for (const Reserved& r : kReservedWords)
      if (code.find(r.word) != code.npos && !BeginsWithOneOf(path, r.places))
        faults.push_back(fmt::format("{}: {} is left to {}", where, r.word, r.places));
  }
  return faults;
}

bool IsSource(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const bool code = name.ends_with(".h") || name.ends_with(".cc");
  return code && !name.ends_with("_test.cc") && !name.ends_with("_fixture.h") && !name.ends_with("_fuzz.cc");
}

TEST(IncludeTable, EveryFileKeepsToIt) {
  const std::filesystem::path root = HYDROSCOPE_SOURCE_DIR;
  int files = 0;
  for (const auto& [folder, allowed] : kMayInclude) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !IsSource(entry.path())) continue;
      ++files;
      std::ifstream in(entry.path());
      const std::string text((std::istreambuf_iterator<char>(in)), {});
      EXPECT_THAT(Faults(std::filesystem::relative(entry.path(), root), text), IsEmpty());
    }
  }
  EXPECT_GT(files, 100) << "the source tree was not found";
}

TEST(IncludeTable, CoversEveryFolderWithCode) {
  std::set<std::string> folders;
  for (const auto& entry : std::filesystem::directory_iterator(HYDROSCOPE_SOURCE_DIR)) {
    if (!entry.is_directory() || !std::filesystem::exists(entry.path() / "CMakeLists.txt")) continue;
    folders.insert(entry.path().filename());
  }
  for (const char* outside : {"tests", "bench", "build"}) folders.erase(outside);
  for (const std::string& folder : folders)
    EXPECT_TRUE(kMayInclude.contains(folder)) << folder << "/ is missing in the table";
}

TEST(IncludeTable, NamesALayerThatLooksUp) {
  EXPECT_THAT(Faults("models/x.cc", "#include \"core/result.h\"\n#include \"estimation/gram_fit.h\"\n"),
              ElementsAre("models/x.cc:2: models/ may include {\"core\"}, not estimation/"));
}

TEST(IncludeTable, KeepsWhatAMachineIsInItsFolder) {
  EXPECT_EQ(Faults("workbench/x.cc", "#include \"machines/die_cushion/balance.h\"\n").size(), 2u);
  EXPECT_EQ(Faults("workbench/x.cc", "if (machine.model == \"die_cushion\") return;\n").size(), 1u);
  EXPECT_EQ(Faults("machines/die_cushion/x.cc", "const char* id = \"die_cushion\";\n").size(), 0u);
}

TEST(IncludeTable, KeepsNamesOfSignalsParametersAndEffectsInTheFolderOfTheirMachine) {
  EXPECT_THAT(Faults("report/x.cc", "if (name == \"Q_vn\") return;\n"),
              ElementsAre("report/x.cc:1: \"Q_vn\" of a machine belongs into machines/"));
  EXPECT_EQ(Faults("pipeline/x.cc", "machine.SignalIndex(\"p_A\");\n").size(), 1u);
  EXPECT_EQ(Faults("workbench/x.cc", "Exclude(\"internal_leakage\"); // \"y_v\"\n").size(), 1u);
  EXPECT_EQ(Faults("workbench/x.cc", "fmt::format(\"expected e.g. {}/p_A\");\n").size(), 1u);
  EXPECT_EQ(Faults("workbench/x.cc", "fmt::format(\"pressure and opening\"); // p_A and y_v\n").size(), 0u);
  EXPECT_EQ(Faults("report/x.cc", "if (kind.id == \"pump\") return;\n").size(), 1u);
}

TEST(IncludeTable, ListsNoFileThatNamesNothingAnyMore) {
  for (const auto& [path, why] : kNameThings) {
    std::ifstream in(std::filesystem::path(HYDROSCOPE_SOURCE_DIR) / path);
    bool any = false;
    for (std::string line; std::getline(in, line);)
      for (const std::string& literal : Literals(line)) any = any || !MachineNameIn(literal, true).empty();
    EXPECT_TRUE(any) << path << " can be taken off the list";
  }
}

TEST(IncludeTable, KeepsTheSimulatorApartFromTheEquations) {
  EXPECT_EQ(Faults("simulator/x.cc", "#include \"machines/die_cushion/balance.h\"\n").size(), 1u);
  EXPECT_EQ(Faults("simulator/x.cc", "#include \"estimation/gram_fit.h\"\n").size(), 1u);
  EXPECT_EQ(Faults("simulator/x.cc", "#include \"diagnosis/explain.h\"\n").size(), 1u);
}

TEST(IncludeTable, KeepsDatabaseAndFieldbusInTheirFolders) {
  EXPECT_EQ(Faults("workbench/x.cc", "#include <sqlite3.h>\n").size(), 1u);
  EXPECT_EQ(Faults("storage/x.cc", "#include <sqlite3.h>\n").size(), 0u);
  EXPECT_EQ(Faults("workbench/x.cc", "#include <modbus/modbus.h>\n").size(), 1u);
  EXPECT_EQ(Faults("acquisition/modbus/x.cc", "#include <modbus/modbus.h>\n").size(), 0u);
  EXPECT_EQ(Faults("acquisition/x.cc", "#include <fastdds/dds/domain/DomainParticipant.hpp>\n").size(), 1u);
}

TEST(IncludeTable, KeepsClocksAndEnvironmentOutOfTheLayersBelowTheService) {
  EXPECT_EQ(Faults("replay/x.cc", "auto t = std::chrono::system_clock::now();\n").size(), 1u);
  EXPECT_EQ(Faults("replay/x.cc", "// no system_clock here\n").size(), 0u);
  EXPECT_EQ(Faults("core/x.cc", "std::getenv(\"HOME\");\n").size(), 1u);
}

}  // namespace
}  // namespace hydroscope
