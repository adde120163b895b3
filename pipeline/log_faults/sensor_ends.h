#pragma once

#include <vector>

#include "acquisition/quality_monitor.h"
#include "core/records/sample_block.h"
#include "core/told.h"
#include "models/machine.h"
#include "pipeline/log_faults/cut_off.h"

namespace hydroscope {

/// An end of the range of a sensor or its converter, seen in a whole log.
struct SensorEnd {
  int signal = 0;
  bool upper = true;
  double at = 0;  ///< SI, the highest reading or the lowest
  std::size_t rows = 0;
};

/// Readings pile up at the very highest or lowest value of one of `signals`, which no other value comes near to and no motion
/// settles at: there the sensor or its converter ends. Unlike QualityMonitor, which judges row by row, this needs no noise that
/// turns readings back, so slow signals of few rows show it too. Not where a state of the machine file has its limit, and not at
/// 0, where relieved sensors rest. The rows are flagged kOutOfRange.
std::vector<SensorEnd> FlagSensorEnds(const Machine& machine, const std::vector<int>& signals,
                                      SampleBlock& rows);

/// The same of inputs, whose rows QualityMonitor has flagged: readings at an end that the machine file does not state, without
/// which episodes have to do.
std::vector<SensorEnd> FlaggedInputEnds(const Machine& machine, const std::vector<int>& inputs,
                                        const SampleBlock& rows);

/// Ends as a pass over a log takes them that knows of them beforehand, without a text.
std::vector<CutOff> AsCutOffs(const std::vector<SensorEnd>& ends);

/// Sentences that say so.
Told SensorEndText(const SensorEnd& end, const Machine& machine);
Told InputEndText(const SensorEnd& end, const Machine& machine);

}  // namespace hydroscope
