#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "workbench/history/history_options.h"
#include "workbench/model/promotion.h"

namespace hydroscope {

/// What `hydroscope model add` and `remove` are asked to do.
struct ModelChange {
  std::string effect, machine, out, name;
  std::vector<std::string> logs;  ///< judged on their strokes together
  std::string hold_out;           ///< one of them, or another: judged on it, not fitted to it
  HistoryOptions history;
};

/// The machine with version `version` changed by the effect: WithEffect or WithoutEffect.
using MakeNext = Result<Machine> (*)(const Machine& machine, const std::string& effect, int version);

struct ModelChanged {
  Machine machine;        ///< as it is now
  std::string text;       ///< what was done, for people
  std::string where;      ///< machine file or database
  bool restored = false;  ///< the file is again byte for byte an earlier version
  /// What speaks against the change, a sentence each; part of `text` too.
  std::vector<Told> warnings = {};
  /// log, strokes, before, after, unit of ModelChange::hold_out; null: none.
  nlohmann::json held_out = {};
  /// before, after, noise_floor, unit: on strokes left out, as shown; null: not judged.
  nlohmann::json error = {};
};

/// Writes the next version of a machine file, or of a database if no machine file is given; judges it on
/// `logs` or on the strokes of the database. Taking out what was added last brings the file from before back,
/// byte for byte, if it is kept beside. Nothing is written if something is wrong.
Result<ModelChanged> ChangeModel(const ModelChange& change, MakeNext make_next);

/// Brings the version before back; its file must be kept beside. Error: there is none.
Result<ModelChanged> UndoModel(const std::string& machine_file);

/// Makes a model the one of replay and monitor: that of `machine_file`, or of none the version of `promotion`, which the database
/// holds (0 = its latest). Whose it is, is found out; user, comment and time are those of `promotion`. Errors: as Promote.
Result<ModelChanged> PromoteModel(const HistoryOptions& history, const std::string& machine_file,
                                  Promotion promotion);

/// The machine as the newest version in the database has it.
Result<Machine> NewestStoredModel(const Database& database, const HistoryPart& part);

}  // namespace hydroscope
