#pragma once

#include <string>
#include <vector>

#include "report/report.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// The explanation as sections of an HTML page: verdict in plain words with what to check on the machine,
/// staircase of the error, model against measurement, residual map, ranking, parameters before and after,
/// what cannot be tested, what to record next, versions of the model.
/// Without `overlays` the model is not shown against the measurement.
std::string ExplainSections(const ExplainResult& result, bool overlays = true);

/// Makes it part of a maintenance report, which it leads if the model misses something. `lead`: what the strokes are, "" = all.
void AddExplanation(const ExplainResult& result, const std::string& lead, ReportInput& report);

/// Writes one self-contained HTML page (inline SVG and CSS, light and dark, prints on A4). Fails if the file
/// cannot be written.
Status WriteExplainReport(const std::string& path, const std::vector<ExplainResult>& results);

}  // namespace hydroscope
