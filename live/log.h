#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace hydroscope {

/// The log of the service on stderr: one event per line, `time level event key=value ...` or JSON. Under
/// systemd (JOURNAL_STREAM) the time is left to the journal and the level is its prefix (sd-daemon(3)).
using LogFields = std::vector<std::pair<const char*, std::string>>;

/// `level`: "debug", "info", "warning", "error", "off"; `json`: one JSON object per line.
Status ConfigureLog(const std::string& level, bool json);

/// A line of the log, without its time and level.
struct LogLine {
  double wall = 0;  ///< s since 1970
  std::string level, text;
};
/// The newest lines that were written, oldest first: what people see who do not read stderr.
std::vector<LogLine> NewestLogLines();

void LogInfo(const char* event, const LogFields& fields = {});
void LogWarning(const char* event, const LogFields& fields = {});
void LogError(const char* event, const LogFields& fields = {});

}  // namespace hydroscope
