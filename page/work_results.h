#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "page/api_arguments.h"
#include "workbench/model/model_change.h"

namespace hydroscope {

/// What work is done on: paths of logs, the one of them that models are not fitted to ("" = none), and a machine file.
struct WorkInput {
  std::vector<std::string> logs;
  std::string hold_out, machine_file;
};

/// What `check`, `fit`, `compare` and `explain` give of it: the JSON of the commands, with `text`, what they print.
/// `strokes` gets the pictures of the strokes where `compare` has some.
Result<nlohmann::json> WorkOut(WorkRequest::Kind kind, const WorkInput& input, nlohmann::json& strokes);

/// What `model add` or `remove` does to the machine file, written to `out` (which is replaced) in its place: `effect`,
/// `error`, `held_out`, `warnings`, `parameters_before` and `parameters_after`.
Result<nlohmann::json> TryChange(const std::string& effect, MakeNext make_next, const WorkInput& input,
                                 const std::string& out);

/// Factor, offset and name of every unit that signals, parameters and effects of the machine have.
nlohmann::json UnitsJson(const Machine& machine);

}  // namespace hydroscope
