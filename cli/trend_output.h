#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/counted_words.h"
#include "core/records/alarm_records.h"
#include "core/result.h"
#include "pipeline/geometry_tolerance.h"
#include "storage/database.h"
#include "workbench/history/trend_summary.h"

namespace hydroscope {

/// The trends of one machine as asked for; the points themselves stay in the database.
struct MachineTrends {
  std::string machine;
  std::int64_t id = 0;
  std::vector<RunInfo> runs;
  std::int64_t begin = 0, end = 0;  ///< strokes with begin <= sequence < end
  TrendPoint first, last;           ///< of the points
  std::vector<TrendSummary> summaries;
  std::vector<AssumedTolerance> assumed;  ///< tolerances that the intervals of the newest estimates rest on
  CountedWords counted;                   ///< what its points stand for
  std::vector<Told> unusual;              ///< what makes the newest estimates doubtful
  std::vector<AlarmState> alarms;         ///< of the drift watch, that tell a change and stand
};

/// Shows the points of a machine one by one, in order of sequence, until one is refused with false. Error: the database
/// cannot be read.
using TrendPoints =
    std::function<Status(const MachineTrends&, const std::function<bool(const TrendPoint&)>&)>;

/// Table for people: latest value with 95 % interval in the units of the shop floor, strokes, last excited,
/// change over the strokes shown, sparkline; below it one sentence for each parameter that the last stroke
/// did not update.
std::string TrendText(const MachineTrends& trends);

/// machine,run,stroke,sequence,time_s,parameter,value,std,unit,oil_temperature_degC,reason,excitation,last_excited_s;
/// SI units, every digit of the doubles, empty where nothing is known. "-" is stdout.
Status WriteTrendCsv(const std::string& path, const std::vector<MachineTrends>& machines,
                     const TrendPoints& points);

/// One machine: {"machine", "points": [...], "summary": [...]}; several: {"machines": [...]} of such objects.
/// Written point by point: as a tree in memory a point takes a kilobyte and a half. "-" is stdout.
Status WriteTrendJson(const std::string& path, const std::vector<MachineTrends>& machines,
                      const TrendPoints& points);

}  // namespace hydroscope
