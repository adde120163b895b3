#pragma once

#include <vector>

#include "pipeline/stroke_overlays.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {

/// The stroke of median and the one of largest error, with the model as it is and extended; empty without samples.
std::vector<StrokeOverlay> ExplainOverlays(const ExplainResult& result);

}  // namespace hydroscope
