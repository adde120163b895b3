#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/explain/explain_change.h"

namespace hydroscope {

/// "press 7: strokes 0 to 99, judged in 2 groups of 64." for people.
std::string HistoryLine(const StrokeHistory& history);

/// ExplainJson with the keys of a database added: `database`, `machines`, `units`, `strokes_per_unit`.
nlohmann::json HistoryJson(const StrokeHistory& history, const ExplainResult& result);

/// What changed, for people: verdict, parameters and effects before and after.
std::string ChangeText(const ChangeResult& result);
/// HistoryJson of the strokes after, with `change` (docs/command_line.md).
nlohmann::json ChangeJson(const StrokeHistory& before, const StrokeHistory& after,
                          const ChangeResult& result);

}  // namespace hydroscope
