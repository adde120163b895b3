#pragma once

#include <string>
#include <vector>

#include "report/report.h"
#include "workbench/history/stroke_history.h"

namespace hydroscope {

/// The strokes of `part` behind the last one of another version of the model than that of its newest run: those of several
/// versions explained as one by the newest would err where the machine did not change.
HistoryPart OfNewestVersion(HistoryPart part, const std::vector<RunInfo>& runs);

/// Which of the strokes of a report an explanation is about, where the record mixes versions of the model; "" of one version.
std::string WhichStrokes(const ReportInput& report, const HistoryPart& part);

/// Adds to a report what `explain --db` says of the strokes of `part`, nothing if these cannot be explained. Its alarms are there.
void AddStoredExplanation(const Database& database, const std::string& path, const HistoryPart& part,
                          const Machine& machine, ReportInput& report);

}  // namespace hydroscope
