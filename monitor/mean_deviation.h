#pragma once

#include <span>

#include "monitor/axis_monitor.h"

namespace hydroscope {

/// Consecutive judged strokes together, weighted by what each of them tells of one quantity.
struct MeanDeviation {
  int strokes = 0;                           ///< that tell something; 0: the rest says nothing
  double stroke = 0;                         ///< number, mean
  double oil_temperature = 0;                ///< K, mean
  double value = 0, std = 0, reference = 0;  ///< SI; `std` is the sampling of `value`
  double doubt = 0;                          ///< SI, std of the reference itself, mean
};
MeanDeviation MeanDeviationOf(std::span<const AxisMonitor::JudgedValue> strokes, int quantity);

}  // namespace hydroscope
