#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "storage/database.h"
#include "workbench/history/block_estimates.h"

namespace hydroscope {

/// The trends of one machine as asked for.
struct MachineTrends {
  std::string machine;
  std::vector<RunInfo> runs;
  std::vector<TrendPoint> points;      ///< in order of sequence
  std::vector<BlockEstimates> blocks;  ///< of the same strokes; empty if they could not be fitted
  std::vector<StrokeSummary> strokes;  ///< of some of them, `index` being the sequence
};

/// Table for people: latest value with 95 % interval in the units of the shop floor, strokes, last excited,
/// change over the strokes shown, sparkline; below it one sentence for each parameter that the last stroke
/// did not update.
std::string TrendText(const MachineTrends& trends);

/// machine,run,stroke,sequence,time_s,parameter,value,std,unit,oil_temperature_degC,reason,excitation,last_excited_s;
/// SI units, every digit of the doubles, empty where nothing is known. "-" is stdout.
Status WriteTrendCsv(const std::string& path, const std::vector<MachineTrends>& machines);

/// One machine: {"machine", "points": [...], "summary": [...]}; several: {"machines": [...]} of such objects.
/// Written point by point: as a tree in memory a point takes a kilobyte and a half. "-" is stdout.
Status WriteTrendJson(const std::string& path, const std::vector<MachineTrends>& machines);

}  // namespace hydroscope
