#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/units.h"
#include "diagnosis/remainder/locate.h"

namespace hydroscope {

/// Edges of the cells of a map along one of its signals, as shown.
std::vector<double> MapEdges(const ErrorMap& map, const std::vector<ResidualSignal>& signals,
                             std::size_t axis);

/// SVG heat map of a model's error over two signals, in `unit`; "" with fewer than two edges a side. `diverging`: mean of
/// measured minus modelled in place of the rms.
std::string ErrorMapPlot(const ErrorMap& map, const std::vector<ResidualSignal>& signals,
                         const DisplayUnit& unit, bool diverging);

}  // namespace hydroscope
