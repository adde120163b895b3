#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "models/machine.h"
#include "storage/database.h"
#include "workbench/model/model_record.h"

namespace hydroscope {

/// The versions of a model as a staircase: error on strokes left out beside sensor noise, and every parameter
/// with its 95 % interval from version to version.
std::string ModelHistoryText(const Machine& machine);
/// The JSON of docs/command_line.md: errors in l/min, parameters in SI.
nlohmann::json ModelHistoryJson(const Machine& machine);

/// What a change of the model achieved: the last two versions of the history; "" if they were not judged.
std::string LastStepText(const Machine& machine);

/// What speaks against adding `effect` by the last two versions of the history, a sentence each: the error
/// on strokes left out does not fall, or by no more than chance, a value is one that physics forbids, or the size cannot be
/// told from zero. `before` and `next` are what the two were judged on. [] if nothing does or they were not judged.
std::vector<Told> AddingWarnings(const Machine& machine, const std::string& effect,
                                 const ModelEvidence& before = {}, const ModelEvidence& next = {});

/// Errors of the last two versions on strokes left out, as shown; null if they were not judged.
nlohmann::json LastStepJson(const Machine& machine);

/// The versions a database holds, and which one is in force.
std::string StoredVersionsText(const std::vector<ModelVersion>& versions);
nlohmann::json StoredVersionsJson(const std::vector<ModelVersion>& versions);

}  // namespace hydroscope
