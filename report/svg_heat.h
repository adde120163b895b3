#pragma once

#include <string>

#include "report/svg_plot.h"

namespace hydroscope {

/// Range of the colours of a heat map: that of its values, or symmetrical about 0 if diverging; 0...1 if it
/// is empty.
AxisRange HeatRange(const SvgPlot::HeatLayer& layer);

/// "#rrggbb" at `share` 0...1 of the range. Sequential: cividis (Nuñez, Anderton, Renslow 2018) in five
/// stations. Diverging: blue over pale grey to vermillion.
std::string HeatColour(double share, bool diverging);

/// The colour scale: a bar at `x` from `top` to `bottom` px with ticks, its name at the right end of `width`.
std::string HeatScale(const SvgPlot::HeatLayer& layer, double x, double top, double bottom, double width);

}  // namespace hydroscope
