#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "replay/log_reader.h"

namespace hydroscope {

/// RunInfo::source of what the live service identifies; of others it is the path of a log.
inline constexpr char kLiveSource[] = "live";

/// What became of the rows of one log; kept with its run as JSON (RunInfo::summary_json).
struct RunSummary {
  double sample_period = 0;            ///< s
  std::int64_t rows = 0;               ///< rows delivered by the reader
  std::int64_t rejected_rows = 0;      ///< rows that could not be read at all
  std::int64_t gated = 0;              ///< rows inside the gate
  std::int64_t used = 0;               ///< rows that entered the identification
  std::int64_t discarded_strokes = 0;  ///< shorter than min_stroke
  /// Values per channel and flag name ("p_A" -> "spike" -> 3).
  std::map<std::string, std::map<std::string, std::int64_t>> flagged;
  std::vector<std::string> absent;    ///< optional signals the log does not have
  std::vector<LogFinding> findings;   ///< the first few
  std::vector<std::string> warnings;  ///< what makes conclusions from this log doubtful (LogTrust)
  /// Why its rows are too far apart to conclude anything from them, "" if they are not.
  std::string too_slow;
  std::string
      impossible;  ///< readings that no machine makes, so that nothing is to be concluded (ReadingFaults); "": none
  /// Noise energy of an equation over what neighbouring rows show, and of how many equations one is worth, as `explain` finds
  /// them where noise goes on from row to row; 1: as rows show. Nothing: nobody looked.
  std::optional<double> noise_scale, evidence_scale;
  /// Energy of the noise floor (flow form) that `explain` trusts there, over that of white noise; absent where `noise_scale` is 1.
  std::optional<double> floor_scale;
  std::string stopped;  ///< why reading ended before the end of the log, "" if it did not

  std::int64_t FlaggedValues() const;
};

std::string FormatRunSummary(const RunSummary& summary);
/// Keys that are absent are taken as zero; text that is no JSON object gives an empty summary.
RunSummary ParseRunSummary(const std::string& json);

/// "line 17, column p_A: found 'x', expected a number"
std::string FindingText(const LogFinding& finding);

}  // namespace hydroscope
