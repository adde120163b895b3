#pragma once

#include <string>

#include "report/report.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {

/// Adds to a report what `explain --db` says of the strokes of `part`, nothing if these cannot be explained. Its alarms are there.
void AddStoredExplanation(const Database& database, const std::string& path, const HistoryPart& part,
                          const Machine& machine, ReportInput& report);

}  // namespace hydroscope
