#pragma once

#include <optional>
#include <string>

#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// What to record so that the next `explain` says more; nullopt if these strokes already answer the question.
/// Ambiguous: moves that separate the rivals. Otherwise: what kept the strokes from testing the library, such
/// as one ram speed for all of them.
std::optional<Told> WhatToRecord(const ExplainResult& result);

/// Strokes, or a test, that tell two effects apart: what one says of the other, else what shows one of them at all.
Told WhatTellsApart(const ExplainResult& result, const std::string& id, const std::string& other);

/// How the command line is told what the tests off the log gave that WhatToRecord speaks of; "" where it speaks of none.
std::string MeasuredArguments(const ExplainResult& result);

}  // namespace hydroscope
