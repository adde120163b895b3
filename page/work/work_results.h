#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "diagnosis/explain.h"
#include "page/api_arguments.h"
#include "page/work/region_errors.h"
#include "page/work/term_course.h"
#include "workbench/model/model_change.h"

namespace hydroscope {

/// What work is done on: paths of logs, the one of them that models are not fitted to ("" = none), a machine file, and what tests
/// off the logs said of effects.
struct WorkInput {
  std::vector<std::string> logs;
  std::string hold_out, machine_file;
  std::map<std::string, MeasuredSize> measured = {};

  /// The newest log that nothing is compared with.
  std::string Newest() const;
};

/// What `compare` and `explain` found stroke by stroke.
struct StrokeFindings {
  nlohmann::json pictures = nlohmann::json::array();  ///< StrokePicturesJson
  RegionErrors errors;
  std::shared_ptr<const TermStroke> term;  ///< for terms that are being written; null: nothing was compared
};

/// What `check`, `fit`, `compare` and `explain` give of it: the JSON of the commands, with `text`, what they print.
/// `strokes` gets what `compare` and `explain` find of them.
Result<nlohmann::json> WorkOut(WorkRequest::Kind kind, const WorkInput& input, StrokeFindings& strokes);

/// What `model add` or `remove` does to the machine file, written to `out` (which is replaced) in its place: `effect`,
/// `error`, `held_out`, `warnings`, `parameters_before` and `parameters_after`.
Result<nlohmann::json> TryChange(const std::string& effect, MakeNext make_next, const WorkInput& input,
                                 const std::string& out);

/// Factor, offset and name of every unit that signals, parameters and effects of the machine have.
nlohmann::json UnitsJson(const Machine& machine);

}  // namespace hydroscope
