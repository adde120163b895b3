#pragma once

#include <string>

#include "core/result.h"
#include "models/machine.h"
#include "storage/database.h"

namespace hydroscope {

/// A model that replay and service shall go by, for whom and why.
struct Promotion {
  std::string machine;  ///< of the database
  std::int64_t id = 0;  ///< the same, its number
  std::string text;     ///< machine file with the model; "" = `version` of the database
  int version = 0;
  std::string user, comment;  ///< for the alarm journal beside the database
  double wall = 0;            ///< s since 1970
};

/// `machine`, as it is recorded, with the effects of `model`, their values and history; effects of one's own come along where
/// the two are otherwise the same. Error: what it lacks of them, a signal for example.
Result<Machine> WithModelOf(const Machine& machine, const Machine& model);

/// Stores the text of a machine file as a version of the model of machine `id`, if it differs from the latest; its number.
/// Errors: `machine`, which it says, cannot be built, or the database cannot be written.
Result<int> StoreModel(Database& database, std::int64_t id, const std::string& text, const Machine& machine);

/// What was promoted, and as which version.
struct Promoted {
  Machine machine;
  int version = 0;
};
/// Makes it the model of replay and service (Database::PromoteModel) and tells it to the alarm journal beside the database at
/// `path` as `model_promoted`, if there is one. Errors: the machine as its last run recorded it lacks what the model needs,
/// there is no such version, database or journal cannot be written; but for the last nothing is changed then.
Result<Promoted> Promote(Database& database, const std::string& path, const Promotion& promotion);

}  // namespace hydroscope
