#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "models/machine.h"
#include "workbench/model/model_record.h"

namespace hydroscope {

/// The machine with `version` as its next model and the effect added. Errors: unknown id (names the nearest
/// one), already part of the model, or a signal it needs is not in the machine file.
Result<Machine> WithEffect(const Machine& machine, const std::string& id, int version);
/// The same without it. Error: it is not part of the model.
Result<Machine> WithoutEffect(const Machine& machine, const std::string& id, int version);

/// Adds what the models before and after achieved to the history of `next`; nullopt: not judged. A record of
/// the version before that is there already is replaced by a judged one. The name of the new version is
/// `name`, "" for ModelName.
void AddRecords(const Machine& before, const std::optional<ModelEvidence>& evidence_before,
                const std::optional<ModelEvidence>& evidence_next, const std::string& name, Machine& next);

/// The text of a machine file with model version, effects, their values and history of `next`, comments and
/// layout kept; written anew where that is not possible. `text` is the file of the version before.
std::string EditedMachineText(const std::string& text, const Machine& next);

/// A version of a machine file that was kept beside it: "press.v1.toml" beside "press.toml".
struct KeptVersion {
  int version = 0;
  std::string path;
};
/// In order of version.
std::vector<KeptVersion> KeptVersions(const std::string& path);

/// A number no version of this machine file had.
int NextVersion(const std::string& path, const Machine& machine);

/// The kept version with the model of `wanted` and everything else of `machine`, newest first; nullopt if
/// there is none.
std::optional<KeptVersion> FindKept(const std::string& path, const Machine& machine, const Machine& wanted);

/// Writes `next` to `path`. If the file is there already, its present text is kept beside it, with the model
/// version in the name ("press.v1.toml"). Returns the name of that file, "" if none was needed.
Result<std::string> WriteVersion(const std::string& from, const std::string& path, int version_before,
                                 const Machine& next);

/// Puts the bytes of a kept version back in place; the present ones are kept beside. Returns their name.
Result<std::string> RestoreVersion(const std::string& path, int version_before, const KeptVersion& kept);

}  // namespace hydroscope
