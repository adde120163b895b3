#pragma once

#include <string>
#include <vector>

#include "report/report.h"
#include "workbench/history/trend_analysis.h"

namespace hydroscope {

/// Flow errors of the whole record in m^3/s, as given or the medians over the strokes; 0 if unknown.
struct FlowErrors {
  double rms = 0, floor = 0;
};
FlowErrors OverallErrors(const ReportInput& input);

/// Growth of the error worth a sentence, of its size at first: as much is within what counts as at the noise floor.
bool ErrorGrew(const ThirdsComparison& ratio);

/// What the error of the model says about it, as HTML; nothing if it is not known.
void AddErrorSentence(std::vector<std::string>& out, const ReportInput& input, const TrendAnalysis& analysis);

}  // namespace hydroscope
