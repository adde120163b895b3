#pragma once

#include <string>

namespace hydroscope {

/// Whether a time counts from 1970 (s) rather than from the beginning of a log: later than 2001.
bool CountsFrom1970(double seconds);

/// "2026-03-01 15:05:09" in the time zone of this computer (TZ), of seconds since 1970.
std::string LocalTimeText(double wall);

/// "350 ms", "12.3 s", "5.0 min", "3.4 h", "10.2 days"; "0 s" of what is not positive, "-" of no number.
std::string DurationText(double seconds);

}  // namespace hydroscope
