#pragma once

#include <string>
#include <vector>

#include "models/machine.h"
#include "report/report.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// SVG: error on strokes left out, from the model as it is to the extended one, beside what sensor noise leaves.
std::string StaircasePlot(const ExplainResult& result);

/// SVG: for every effect that can be tested, the model error left with it, in % of that of the model as it
/// is, with the 95 % interval over the strokes; best first.
std::string RankingPlot(const ExplainResult& result);

/// SVG heat map: model error over the two signals that explain it best; "" without samples. `diverging`: mean
/// of measured minus modelled in place of the rms.
std::string ResidualMap(const ExplainResult& result, bool diverging);

/// SVG of the versions of a model: error on strokes left out of those that were judged; "" if fewer than two were.
std::string HistoryPlot(const Machine& machine);

}  // namespace hydroscope
