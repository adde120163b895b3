#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/log_fingerprint.h"
#include "replay/log_reader.h"
#include "storage/database.h"

namespace hydroscope {

/// A piece of the raw window of a trend database, named like a log:
///
///   press.db#cushion_1          everything kept of axis cushion_1
///   press.db#cushion_1/12       run 12 of it
///   press.db#cushion_1/12@5:60  of that (or of all runs) only s 5 to 60 after its first row
///   press.db#cushion_1/12@=1772352005:1772352060  the same by the times of the rows, which stay when the oldest rows go
///
/// The part behind # is the machine's name in the database, or its end behind the last /; it may be empty if
/// the database has one machine.
struct RawName {
  std::string database, axis;
  std::int64_t run = 0;            ///< 0: all
  std::optional<double> from, to;  ///< s after the first row ...
  bool by_time = false;            ///< ... or times of the rows themselves
};
/// nullopt if `log` is no such name (no '#' behind a database file).
std::optional<RawName> ParseRawName(const std::string& log);

/// A raw window as a log: values and flags as the aligner gave them out.
Result<std::unique_ptr<LogReader>> OpenRaw(const RawName& name, const Machine& machine);
/// One run of it. Signals that the window lacks are missing.
Result<std::unique_ptr<LogReader>> OpenRawRun(const std::string& database, std::int64_t run, double from,
                                              double to, const Machine& machine);

/// A log file, one of an axis ("press.csv#cushion_1", pipeline/axis_log.h), or a piece of a raw window: what
/// every command that reads logs takes.
Result<std::unique_ptr<LogReader>> OpenRecording(const std::string& log, const Machine& machine);
/// The same with rows `period` s apart where they are nearly so (replay/resampled_reader.h); `note` says what was done to the
/// times of the rows.
Result<std::unique_ptr<LogReader>> OpenRecording(const std::string& log, const Machine& machine,
                                                 double period, std::string& note);
/// Fingerprint of either.
Result<LogFingerprint> FingerprintRecording(const std::string& log);
/// Error where two of these hold the same rows: taken together they would count twice, and intervals come out too narrow.
Status JudgeDistinct(const std::vector<std::string>& logs);

}  // namespace hydroscope
