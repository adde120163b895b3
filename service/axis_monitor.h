#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "alarms/alarm_machine.h"
#include "diagnosis/drift/drift_monitor.h"
#include "models/machine.h"
#include "models/model_structure.h"
#include "storage/alarm_journal.h"
#include "storage/database.h"

namespace hydroscope {

/// The rules file beside a machine file, "press.toml" -> "press_rules.toml", if there is one; else the
/// built-in rules.
Result<drift::RuleBook> RulesFor(const std::string& machine_file);

/// Judges the stored strokes of one axis in their order and keeps its alarms: the consumer of the trend
/// database that replay and live service share. Strokes, alarms, monitor and journal advance together, chunk
/// by chunk in one transaction, so that a killed process neither loses nor repeats a judgement.
///   commissioning: the first strokes of the rules file's `commissioning` are learned and frozen (or by
///   Learn()); then each stroke: drift monitor, limits of [monitor.*], loss of signals -> alarms -> journal.
class AxisMonitor {
 public:
  /// All arguments must outlive the object; `machine_id` is that of `database`.
  AxisMonitor(const Machine& machine, std::shared_ptr<const ModelStructure> model,
              const drift::RuleBook& rules, const Database& database, std::int64_t machine_id,
              AlarmJournal& journal);

  /// An error if the model's parameters cannot be watched; the other functions then fail with it.
  Status watchable() const { return model_ ? Status{} : Status(tl::unexpected(model_.error())); }
  /// Judges every stroke stored since the last call; `wall` in s since 1970. Errors: database or journal
  /// cannot be used.
  Status CatchUp(double wall);
  /// Learns a new reference from the strokes first <= number < last and freezes it; strokes already judged
  /// stay judged.
  Status Learn(std::int64_t first, std::int64_t last, double wall, const AlarmUser& user);
  /// For the live service: press idle, valve check running.
  Status SetSuppression(Suppression reason, bool on, const AlarmMoment& now);

  /// nullptr while commissioning. Valid after CatchUp().
  const drift::DriftMonitor* monitor() const { return monitor_ ? &*monitor_ : nullptr; }
  /// Strokes commissioning has so far and needs.
  std::int64_t commissioning_strokes() const { return commissioning_strokes_; }
  const std::vector<AlarmState>& alarms() const { return alarms_; }
  /// NAMUR NE 107.
  char Health() const { return NamurStatus(alarms_, !monitor_); }

 private:
  struct Stored {
    StrokeRecord record;
    std::int64_t sequence = 0;
    int model_version = 0;
  };
  Result<std::vector<Stored>> Load(std::int64_t first, std::int64_t count) const;
  drift::StrokeEvidence EvidenceOf(const Stored& stroke) const;
  Status LoadMonitor(const AxisContent& content);
  Result<bool> Commission(std::int64_t first, double wall);
  Status LearnFrom(std::vector<drift::StrokeEvidence> strokes, std::int64_t next, double wall,
                   const AlarmUser& user);
  void Judge(const Stored& stroke, double wall, AxisContent& content);
  void JudgeFindings(const AlarmMoment& now, AxisContent& content);
  void JudgeSlowDrifts(const AlarmMoment& now, AxisContent& content);
  void JudgeLimits(const Stored& stroke, const AlarmMoment& now, AxisContent& content);
  void JudgeSignals(const Stored& stroke, const drift::Judgement& judgement, const AlarmMoment& now,
                    AxisContent& content);

  const Machine& machine_;
  const drift::RuleBook& rules_;
  const Database& database_;
  std::int64_t machine_id_;
  AlarmJournal& journal_;
  Result<drift::WatchedModel> model_;
  int columns_;
  std::optional<drift::DriftMonitor> monitor_;
  std::int64_t next_ = -1;  ///< stroke the monitor in memory stands before
  std::int64_t commissioning_strokes_ = 0;
  std::vector<AlarmState> alarms_;
};

}  // namespace hydroscope
