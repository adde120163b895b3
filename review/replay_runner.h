#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/records/alarm_records.h"
#include "core/records/estimate.h"
#include "core/result.h"
#include "estimation/gram_fit.h"
#include "models/machine.h"
#include "pipeline/run_summary.h"
#include "report/report.h"
#include "storage/database.h"
#include "workbench/history/stated_estimates.h"

namespace hydroscope {

struct ReplayOptions {
  std::vector<std::string> logs;  ///< in the order of their recording
  std::string machine_file;
  std::string database;
  std::string report;  ///< HTML file to write, "" = none; of several axes one each, "<report>_<axis>.html"
  std::string axis;    ///< of logs that do not name theirs (pipeline/axis_log.h), "" = not said
};

enum class ReplayStatus {
  kReplayed,   ///< read from beginning to end
  kContinued,  ///< an earlier replay stopped in this log; its strokes were kept, the rest added
  kAlready,    ///< an earlier replay stored it completely
  kFailed,     ///< left out; `problem` says why
};
const char* StatusName(ReplayStatus status);

/// What became of one log.
struct LogReplay {
  std::string log;
  ReplayStatus status = ReplayStatus::kFailed;
  std::string problem;  ///< why it was left out, or why it counts as partly done; "" if all is well
  std::vector<std::string> notes;  ///< worth knowing, nothing to do
  RunInfo run;
  std::int64_t stored_before = 0;  ///< strokes an earlier replay had stored
  RunSummary summary;
  /// Why none of its strokes told of a parameter, a sentence; "" if one did, if all together did, or if they are too few
  /// to expect it beside other logs that did.
  std::string taught_nothing;
};

/// What watching for drift says after a replay (monitor/axis_monitor.h).
struct WatchOutcome {
  std::string problem;        ///< why this machine is not watched, "" if it is
  int reference_version = 0;  ///< 0 = commissioning is not over
  std::int64_t commissioning_strokes = 0, commissioning_needed = 0;
  char health = '-';        ///< NAMUR NE 107
  std::string health_text;  ///< what it comes from
  std::string notice;       ///< what else should be known of journal and rules; "" if nothing
  std::vector<AlarmState> alarms;
  std::string verdict_html, section_html;  ///< for the report; "" without one
};

/// Everything a replay has to tell of one machine of the database.
struct ReplayOutcome {
  Machine machine;
  std::string report;  ///< file written, "" = none
  std::vector<LogReplay> logs;
  std::vector<RunInfo> runs;  ///< all runs of the machine in the database
  WatchOutcome watch;
  std::vector<Estimate> latest;      ///< parameters after the last stroke of the database
  std::vector<SkippedItem> skipped;  ///< over all runs of the machine, and the logs left out now
  std::int64_t strokes = 0;          ///< in the database for this machine
  StatedEstimates stated = {};       ///< what `latest` is stated with

  bool Complete() const;  ///< nothing was left out, and no log taught nothing
  bool Failed() const;    ///< not one log could be replayed
};

/// A replay into one database: of one machine, or of axes of a press.
struct PressReplay {
  std::vector<ReplayOutcome> machines;  ///< those that logs were replayed of
  std::string press;                    ///< its name, "" if the machine file names no axes
  std::vector<AlarmState> alarms;       ///< of the press itself, not at rest

  bool Complete() const;
  bool Failed() const;
};

/// Sends logs through the live pipeline into the trend database, one run per log, each starting from the state the
/// machine's run before left. Deterministic: the same logs into a fresh database give the same content. A replay that
/// was killed continues: complete runs are skipped, the run under way is computed again from its starting state, and
/// strokes already stored are not stored twice. A log that cannot be replayed does not keep the others from it. Then
/// all axes of the press that the database holds are judged together, as the live service does; in which order their
/// logs were replayed makes no difference to what stands. Errors: machine file or database cannot be used, nothing
/// tells whose log it is, report cannot be written.
Result<PressReplay> RunReplay(const ReplayOptions& options);

}  // namespace hydroscope
