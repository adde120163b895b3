#pragma once

#include <string>
#include <vector>

#include "models/counted_words.h"
#include "monitor/axis_monitor.h"

namespace hydroscope {

/// HTML: the database is not being written, and why; "" where `why` is.
std::string NotStoredBox(const std::string& why);

/// HTML: the alarms that stand, in words, those of the press before those of the axis; "" if none does.
std::string AlarmsBox(const std::vector<AlarmState>& press, const std::vector<AlarmState>& axis,
                      const CountedWords& counted = {});

/// HTML: what the healthy machine was learned from, and per watched quantity the learned curve over oil
/// temperature with its points and what was judged since, and the deviation over the strokes. While
/// commissioning, how far it has come. Errors: the database cannot be read.
Result<std::string> DriftSection(const AxisMonitor& axis, int commissioning);

}  // namespace hydroscope
