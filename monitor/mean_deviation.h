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

/// The same of the strokes since a change that `monitor` found and that stands, fitted together with what changed: a leak bends
/// every parameter that is looked at alone. Without a finding, or a stroke since, as MeanDeviationOf.
MeanDeviation MeanDeviationBesideFindings(std::span<const AxisMonitor::JudgedValue> strokes, int quantity,
                                          const drift::DriftMonitor& monitor);

}  // namespace hydroscope
