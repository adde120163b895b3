#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/records/alarm_records.h"

namespace hydroscope {

/// How well the alarm system serves its reader (ISA-18.2, clause 16; IEC 62682).
struct AlarmMetrics {
  std::int64_t annunciations = 0;  ///< alarms raised
  double hours = 0;                ///< from first to last row
  double per_hour = 0;
  int most_in_10_minutes = 0;
  int floods = 0;  ///< spells of 10 minutes or more with more than 10 annunciations in 10 minutes
  std::vector<std::string> chattering;                    ///< raised three times or more within a minute
  std::vector<std::string> stale;                         ///< active for more than a day
  std::vector<std::pair<std::string, std::int64_t>> top;  ///< most frequent first, at most ten
};

/// Rows in order of sequence; `states` as they are now, `now` in s since 1970.
AlarmMetrics MeasureAlarms(std::span<const JournalRow> rows, std::span<const AlarmState> states, double now);

}  // namespace hydroscope
