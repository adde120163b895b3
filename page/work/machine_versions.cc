#include "page/work/machine_versions.h"

#include <map>
#include <nlohmann/json.hpp>

#include "core/told_error.h"
#include "models/machine.h"
#include "workbench/model/model_edit.h"
#include "workbench/model/model_history_output.h"

namespace hydroscope {
namespace {

/// What the history of one file says of itself and of the versions before it.
void Collect(const Machine& machine, std::map<int, nlohmann::json>& versions) {
  const nlohmann::json history = ModelHistoryJson(machine);
  nlohmann::json parent;
  for (const nlohmann::json& entry : history["versions"]) {
    nlohmann::json& known = versions[entry["version"].get<int>()];
    const bool judged = known.is_object() && !known["rms_holdout"].is_null();
    if (!judged) {
      const nlohmann::json first_parent = known.is_object() ? known["parent"] : parent;
      known = entry;
      known["parent"] = first_parent;
    }
    parent = entry["version"];
  }
  if (versions.contains(machine.model_version)) return;
  versions[machine.model_version] = {{"version", machine.model_version},
                                     {"name", ModelName(machine)},
                                     {"effects", machine.added_effects},
                                     {"rms_holdout", nullptr},
                                     {"noise_floor", nullptr},
                                     {"parent", parent},
                                     {"parameters", nlohmann::json::object()}};
}

}  // namespace

Result<nlohmann::json> VersionsJson(const std::string& machine_file) {
  const auto current = TRY(LoadMachine(machine_file));
  std::map<int, nlohmann::json> versions;
  for (const KeptVersion& kept : KeptVersions(machine_file))
    if (const auto machine = LoadMachine(kept.path)) Collect(*machine, versions);
  Collect(current, versions);
  nlohmann::json out = nlohmann::json::array();
  for (auto& [number, version] : versions) {
    version["current"] = number == current.model_version;
    out.push_back(version);
  }
  return out;
}

Status RestoreKept(const std::string& machine_file, int version) {
  const auto current = TRY(LoadMachine(machine_file));
  if (current.model_version == version) return {};
  for (const KeptVersion& kept : KeptVersions(machine_file))
    if (kept.version == version) return PutVersion(machine_file, current.model_version, kept.path);
  return BadInput(
      Tell("version {} of the model is not kept", "Version {} des Modells ist nicht aufbewahrt", version));
}

Status PutVersion(const std::string& machine_file, int version, const std::string& next) {
  const auto kept = TRY(RestoreVersion(machine_file, version, {0, next}));
  return {};
}

}  // namespace hydroscope
