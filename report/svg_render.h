#pragma once

#include <string>
#include <vector>

#include "report/svg_plot.h"

namespace hydroscope {

/// The drawing behind SvgPlot::Render.
std::string RenderPlot(const SvgPlot::Options& options, const std::vector<SvgPlot::Layer>& layers);

}  // namespace hydroscope
