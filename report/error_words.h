#pragma once

#include <set>
#include <string>
#include <vector>

#include "report/report.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {

/// Versions of the model that strokes were recorded with.
std::set<int> VersionsOf(const std::vector<RunInfo>& runs);

/// Errors of the whole record, SI of the output, as given or the medians over the strokes; 0 if unknown.
struct ModelErrors {
  double rms = 0, floor = 0;
};
ModelErrors OverallErrors(const ReportInput& input, const TrendAnalysis& analysis);

/// Growth of the error worth a sentence, of its size at first: as much is within what counts as at the noise floor.
bool ErrorGrew(const ThirdsComparison& ratio);

/// What the error of the model says about it, as HTML; nothing if it is not known.
void AddErrorSentence(std::vector<std::string>& out, const ReportInput& input, const TrendAnalysis& analysis);

}  // namespace hydroscope
