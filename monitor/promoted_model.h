#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "models/machine.h"
#include "models/model_structure.h"
#include "storage/database.h"

namespace hydroscope {

/// A machine file with the model that was promoted for an axis.
struct PromotedMachine {
  int version = 0;  ///< in the database
  Machine machine;
  std::string text;  ///< that describes it
};

/// What replay and live service go by: `machine`, as the file `text` has it, with effects, their values and history of the
/// model promoted last for machine `id` of the database at `path`; effects of one's own come along where the two are otherwise
/// the same. nullopt: none was promoted, or it is the file's own. Error: it cannot be read, or the machine file lacks its effects.
Result<std::optional<PromotedMachine>> PromotedFor(const Database& database, const std::string& path,
                                                   std::int64_t id, const Machine& machine,
                                                   const std::string& text);

/// All axes of the press that the database at `path` holds, named as there, with the models in force.
Result<std::vector<Machine>> StoredAxes(const std::string& path, const Machine& machine, Database& database);

/// Number of the version with this definition: the promoted one's if it is the same, else it is stored as the latest.
Result<int> VersionFor(Database& database, std::int64_t id, const ModelVersion& model);

}  // namespace hydroscope
