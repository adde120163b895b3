#include "service/model_edit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "models/model_structure.h"
#include "service/machine_model.h"

namespace hydroscope {
namespace {

bool IsAdded(const Machine& machine, const std::string& id) {
  return std::find(machine.added_effects.begin(), machine.added_effects.end(), id) !=
         machine.added_effects.end();
}

std::string Trimmed(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : line.substr(first);
}

/// Whether the line sets `key`.
bool Sets(const std::string& line, const std::string& key) {
  const std::string text = Trimmed(line);
  if (text.rfind(key, 0) != 0) return false;
  const auto after = text.find_first_not_of(" \t", key.size());
  return after != std::string::npos && text[after] == '=';
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

Result<std::string> ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) return BadInput("cannot read {}", path);
  return text.str();
}

Status WriteFile(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.flush();
  if (!file) return BadInput("cannot write {}: check that the folder exists and the disk is not full", path);
  return {};
}

}  // namespace

Result<Machine> WithEffect(const Machine& machine, const std::string& id) {
  if (IsAdded(machine, id))
    return BadInput("effect '{}' is already part of the model of {}", id, machine.name);
  const auto model = BuildModel(machine);
  if (!model) return tl::unexpected(model.error());
  if (const auto effect = FindEffect(**model, id); !effect) return tl::unexpected(effect.error());
  Machine next = machine;
  next.added_effects.push_back(id);
  ++next.model_version;
  return next;
}

Result<Machine> WithoutEffect(const Machine& machine, const std::string& id) {
  if (!IsAdded(machine, id))
    return BadInput(
        "effect '{}' is not part of the model of {}; its effects: {}", id, machine.name,
        machine.added_effects.empty() ? "none" : fmt::format("{}", fmt::join(machine.added_effects, ", ")));
  Machine next = machine;
  std::erase(next.added_effects, id);
  ++next.model_version;
  return next;
}

std::string EditedMachineText(const std::string& text, const Machine& next) {
  std::string effects;
  for (const std::string& id : next.added_effects)
    effects += fmt::format("{}\"{}\"", effects.empty() ? "" : ", ", id);
  const std::string added = fmt::format("model_version = {}\n", next.model_version) +
                            (effects.empty() ? "" : fmt::format("effects = [{}]\n", effects));
  std::string out;
  bool in_machine = false, written = false;
  for (const std::string& line : Lines(text)) {
    if (Trimmed(line).rfind('[', 0) == 0) in_machine = Trimmed(line).rfind("[machine]", 0) == 0;
    if (in_machine && (Sets(line, "model_version") || Sets(line, "effects"))) continue;
    out += line + "\n";
    if (in_machine && !written) {
      out += added;
      written = true;
    }
  }
  const auto read_back = ParseMachine(out, "machine file");
  return read_back && *read_back == next ? out : FormatMachine(next);
}

Result<std::string> WriteVersion(const std::string& from, const std::string& path, int version_before,
                                 const Machine& next) {
  const auto text = ReadFile(from);
  if (!text) return tl::unexpected(text.error());
  std::string kept;
  if (std::filesystem::exists(path)) {
    const auto replaced = ReadFile(path);
    if (!replaced) return tl::unexpected(replaced.error());
    const std::filesystem::path target(path);
    kept = (target.parent_path() /
            fmt::format("{}.v{}{}", target.stem().string(), version_before, target.extension().string()))
               .string();
    if (const Status written = WriteFile(kept, *replaced); !written) return tl::unexpected(written.error());
  }
  if (const Status written = WriteFile(path, EditedMachineText(*text, next)); !written)
    return tl::unexpected(written.error());
  return kept;
}

}  // namespace hydroscope
