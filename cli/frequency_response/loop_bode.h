#pragma once

#include <string>

#include "workbench/frequency_response/loop_log.h"

namespace hydroscope {

/// Bode plot of a machine in closed loop as a self-contained SVG.
std::string LoopBodePlot(const LoopLog& measured, const std::string& title);

}  // namespace hydroscope
