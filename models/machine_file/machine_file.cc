#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/told_error.h"
#include "models/machine.h"
#include "models/machine_file/keys.h"
#include "models/machine_file/sections.h"
#include "models/machine_kind.h"

namespace hydroscope {
namespace {

constexpr std::uintmax_t kMaxBytes = 4u << 20;

/// Parts of one dotted key: more, and the parser calls itself until the stack is gone.
constexpr int kMaxKeyParts = 32;

/// Number of the first line whose key or header has too many parts, 0 if none has. Text in quotes counts as well: what a
/// machine file states is far below.
int LineOfDeepKey(const std::string& text) {
  int line = 1, parts = 1;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      parts = 1;
    } else if (c == '=' || c == ' ' || c == '"' || c == '#') {
      parts = 1;
    } else if (c == '.' && ++parts > kMaxKeyParts) {
      return line;
    }
  }
  return 0;
}

Result<toml::table> ParseToml(const std::string& text, const std::string& origin) {
  if (const int line = LineOfDeepKey(text); line > 0)
    return BadInput(Tell("{}:{}: a key of more than {} parts; is this a machine file?",
                         "{}:{}: ein Schlüssel aus mehr als {} Teilen; ist das eine Maschinendatei?", origin,
                         line, kMaxKeyParts));
  try {
    return toml::parse(text, origin);
  } catch (const toml::parse_error& error) {
    return BadInput(Tell("{}:{}: this is no valid TOML at column {}: {}",
                         "{}:{}: kein gültiges TOML in Spalte {}: {}", origin, error.source().begin.line,
                         error.source().begin.column, error.description()));
  }
}

/// What its kind takes a value to be that the file does not state.
void FillGeometry(Machine& machine) {
  for (const MachineInput& input : KindOf(machine).geometry)
    if (input.otherwise)
      machine.geometry.try_emplace(std::string(input.name), KnownValue{*input.otherwise, 0.0});
}

}  // namespace

Result<Machine> LoadMachine(const std::string& path) {
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure == std::errc::no_such_file_or_directory)
    return BadInput(Tell(
        "{0}: there is no such machine file; `hydroscope init LOG --out {0}` proposes one",
        "{0}: diese Maschinendatei gibt es nicht; `hydroscope init LOG --out {0}` schlägt eine vor", path));
  if (failure)
    return BadInput(Tell("{}: the machine file cannot be read: {}",
                         "{}: die Maschinendatei kann nicht gelesen werden: {}", path, failure.message()));
  if (size > kMaxBytes)
    return BadInput(
        Tell("{}: {} bytes is too large for a machine file (expected some kilobytes); is it a log?",
             "{}: {} Bytes sind zu viel für eine Maschinendatei (erwartet einige Kilobyte); ist das ein Log?",
             path, size));
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file)
    return BadInput(Tell("{}: the machine file cannot be read",
                         "{}: die Maschinendatei kann nicht gelesen werden", path));
  return ParseMachine(text.str(), path);
}

Result<Machine> ParseMachine(const std::string& text, const std::string& origin) {
  const toml::table root = TRY(ParseToml(text, origin));
  FileProblems problems(origin);
  TableReader file(root, "", problems);
  file.AllowOnly(MachineFileKeys(""));
  Machine machine;
  ReadMachineSection(file, machine);
  ReadLogSection(file, machine);
  ReadSignals(file, machine);
  ReadGeometry(file, machine);
  FillGeometry(machine);
  ReadGate(file, machine);
  CompleteGate(machine);
  ReadConditions(file, machine);
  ReadWindow(file, machine);
  ReadEstimator(file, machine);
  ReadValve(file, machine);
  ReadExperiment(file, machine);
  ReadBalance(file, machine);
  ReadEpisodeSection(file, machine);
  ReadStates(file, machine);
  ReadEffects(file, machine);
  ReadMonitors(file, machine);
  ReadLive(file, machine);
  ReadFeeds(file, machine);
  ReadModelHistory(file, machine);
  if (!problems.any()) CheckMachine(file, machine);
  if (problems.any()) return tl::unexpected(problems.ToError());
  if (machine.name.empty()) machine.name = std::filesystem::path(origin).stem().string();
  return machine;
}

}  // namespace hydroscope
