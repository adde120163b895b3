#pragma once

#include <string>

#include "report/svg_plot.h"

namespace hydroscope {

/// Class of PlotStyleSheet() that sets the colour.
const char* InkClass(Ink ink);
/// " stroke-dasharray=..." or nothing for a solid line.
std::string DashAttribute(Dash dash);
/// Coordinate in px with at most one decimal.
std::string Px(double value);
/// Estimated width in px of a label of the plot, subscript marks not counted.
double TextWidth(const std::string& text);
/// Path of a marker of radius `r` about (x, y), px.
std::string MarkerPath(Marker marker, double x, double y, double r);
/// Classes of a marker: colour, filled or hollow.
std::string PointClass(const PointStyle& style);

}  // namespace hydroscope
