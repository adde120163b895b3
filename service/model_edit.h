#pragma once

#include <string>

#include "core/result.h"
#include "models/machine.h"

namespace hydroscope {

/// The next version of the machine's model, with the effect added. Errors: unknown id (names the nearest
/// one), already part of the model, or a signal it needs is not in the machine file.
Result<Machine> WithEffect(const Machine& machine, const std::string& id);
/// The next version without it. Error: it is not part of the model.
Result<Machine> WithoutEffect(const Machine& machine, const std::string& id);

/// The text of a machine file with model version and effects of `next`, comments and layout kept; written
/// anew where that is not possible. `text` is the file of the version before.
std::string EditedMachineText(const std::string& text, const Machine& next);

/// Writes `next` to `path`. If the file is there already, its present text is kept beside it, with the model
/// version in the name ("press.v1.toml"). Returns the name of that file, "" if none was needed.
Result<std::string> WriteVersion(const std::string& from, const std::string& path, int version_before,
                                 const Machine& next);

}  // namespace hydroscope
