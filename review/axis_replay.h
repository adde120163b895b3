#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/axis_log.h"
#include "pipeline/batch_fit.h"
#include "pipeline/log_fingerprint.h"
#include "pipeline/log_pass.h"
#include "pipeline/stroke_overlays.h"
#include "review/replay_runner.h"

namespace hydroscope {

/// Stores the strokes of one axis, or of a machine that is its only one, and writes its report.
class AxisReplay {
 public:
  /// `share.logs` are replayed; `report`: the file to write, "" = none.
  AxisReplay(const ReplayOptions& options, LogsOfAxis share, std::string report, Machine machine,
             Database database)
      : options_(options),
        share_(std::move(share)),
        report_(std::move(report)),
        file_machine_(std::move(machine)),
        database_(std::move(database)) {}

  /// Replays the logs into the database.
  Status Store(ReplayOutcome& outcome);
  /// Warns of strokes that change where a log replayed now begins: they may be another machine's. Needs WatchOutcome::alarms.
  void LookForChange(ReplayOutcome& outcome) const;
  /// Writes the page, if one is asked for.
  Status Report(ReplayOutcome& outcome);

 private:
  struct ReportCollector;

  /// Opens database, model and settings.
  Status Prepare();
  Result<std::string> TakePromotedModel();
  Status ReadEarlierSettings();
  bool IsOfEarlierModel(const std::string& settings) const;
  Result<std::unique_ptr<LogReader>> Open(const std::string& log, std::string& note) const;
  LogReplay ReplayLog(const std::string& log, const std::string& count);
  LogPassHooks KnownOf(const std::string& log) const;
  Status Identify(LogReader& reader, const std::string& what, LogReplay& replay);
  Result<RunFingerprint> Recognise(const std::string& log, LogReplay& replay) const;
  bool ShowsStretches() const;
  Status CollectOverlays(const ReplayOutcome& outcome);
  bool AddChange(const ReplayOutcome& outcome, ReportInput& input) const;
  void Take(ReportCollector& collector, const LogReplay& replay);

  const ReplayOptions& options_;
  LogsOfAxis share_;
  std::string report_;
  Machine file_machine_;  ///< as the file has it, with the promoted model
  Machine machine_;       ///< of this axis
  Database database_;
  std::int64_t machine_id_ = 0;
  int model_version_ = 0;
  std::string settings_;
  std::vector<std::string> earlier_settings_;
  std::string promoted_note_;
  std::shared_ptr<const ModelStructure> model_;
  /// Of the log read last, for the report.
  std::vector<StrokeOverlay> overlays_;
  std::optional<LogStrokes> strokes_;
  std::int64_t overlay_run_ = 0;
};

}  // namespace hydroscope
