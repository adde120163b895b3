#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/result.h"
#include "estimation/frequency_response/frequency_response.h"
#include "models/machine.h"

namespace hydroscope {

/// Command and response of a valve check as read from a log, with the conditions during the check.
struct FrfRecord {
  FrequencyRecord record;              ///< input as share of full command
  std::int64_t rows = 0;               ///< rows read
  std::int64_t left_out = 0;           ///< rows without a usable pair of values
  std::string left_out_why;            ///< "missing 3, out_of_range 12"; "" if none
  Told time_base;                      ///< LogCounters::time_base
  Told twins;                          ///< LogCounters::twins
  std::vector<Told> outside_declared;  ///< DeclaredRanges::Sentences
  double supply_pressure = std::numeric_limits<double>::quiet_NaN();  ///< Pa, mean of p_0; NaN if not logged
  double oil_temperature = std::numeric_limits<double>::quiet_NaN();  ///< K, mean of T_oil; NaN if not logged
};

/// Signals of a frequency response, by name.
struct FrfSignals {
  std::string input, output;
  double full_scale = 1;       ///< SI of the input; the record holds input / full_scale
  std::string set_point = "";  ///< of a closed loop
};

/// Reads input and output (in closed loop the set point too) from `path`; the machine's other signals need not be in the
/// log. The record is cut at gaps, clock jumps and values that are missing or out of range; nothing is
/// interpolated. Flags for standing still and spikes are not heeded: a command may pause, a fast sine jumps
/// by nature. Only the output of a closed loop, which is driven all the time, is left out where it stands (`stuck_time`).
Result<FrfRecord> ReadFrfRecord(const std::string& path, const Machine& machine, const FrfSignals& signals);
/// `why` no response comes of the record of `what`, with the rows that were left out.
Error NotMeasured(const std::string& what, const Error& why, const FrfRecord& record);
/// Of the signals that [valve] names.
Result<FrfRecord> ReadValveRecord(const std::string& path, const Machine& machine);

}  // namespace hydroscope
