#pragma once

#include <string>
#include <vector>

#include "report/svg_plot.h"

namespace hydroscope {

/// Plots of one width, one above the other, as an SVG file that stands by itself and follows the reader's light or dark theme.
/// `title` and `note` stand above them, nothing where they are empty; both may hold anything, they are escaped.
std::string SvgSheet(const std::string& title, const std::string& note, const std::vector<SvgPlot>& plots);

}  // namespace hydroscope
