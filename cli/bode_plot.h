#pragma once

#include <string>

#include "workbench/frequency_response/loop_log.h"
#include "workbench/frequency_response/valve_log.h"

namespace hydroscope {

/// Bode plot as a self-contained SVG: points with 95 % bars, model curve; follows the reader's light or dark theme.
std::string ValveBodePlot(const ValveLog& measured, const std::string& title);
/// ... of a machine in closed loop.
std::string LoopBodePlot(const LoopLog& measured, const std::string& title);

}  // namespace hydroscope
