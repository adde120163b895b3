#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "alarms/alarm_machine.h"
#include "alarms/health.h"
#include "core/records/estimate_statement.h"
#include "diagnosis/drift/drift_monitor.h"
#include "diagnosis/drift/valve_check_monitor.h"
#include "models/counted_words.h"
#include "models/machine.h"
#include "models/model_structure.h"
#include "monitor/finding_history.h"
#include "storage/alarm_journal.h"
#include "storage/database.h"

namespace hydroscope {

/// Judges the stored strokes of one axis in their order and keeps its alarms: the consumer of the trend
/// database that replay and live service share. Strokes, alarms, monitor and journal advance together, chunk
/// by chunk in one transaction, so that a killed process neither loses nor repeats a judgement.
///   commissioning: the first strokes of the rules file's `commissioning` are learned and frozen (or by
///   Learn()), while limits of [monitor.*] and loss of signals, which need no reference, are judged already;
///   then each stroke: drift monitor, limits, loss of signals -> alarms -> journal, and as soon as a finding has
///   enough strokes behind it, what comparing those before and after says; then valve checks.
/// What is said depends on the strokes alone, not on how many were there at a time. A saved state that cannot
/// be read (of another program version, or of a model with other parameters) is made anew from stored
/// strokes, told by an event.
class AxisMonitor {
 public:
  /// All arguments must outlive the object; `machine_id` is that of `database`, `path` its file for messages.
  AxisMonitor(const Machine& machine, std::shared_ptr<const ModelStructure> model,
              const drift::RuleBook& rules, const Database& database, std::string path,
              std::int64_t machine_id, AlarmJournal& journal);

  /// An error if the model's parameters cannot be watched; the other functions then fail with it.
  Status watchable() const { return model_ ? Status{} : Status(tl::unexpected(model_.error())); }
  /// Takes over what the journal has and judges nothing, for those who only look on: the journal may be open for reading.
  /// JudgedHealth() then answers as for those who judge. Error: its state was written with other rules or by another
  /// version of the program.
  Status Look();
  /// Judges every stroke and valve check stored since the last call; `wall` in s since 1970. Errors: database
  /// or journal cannot be used.
  Status CatchUp(double wall);
  /// Learns a new reference from the strokes first <= number < last and freezes it; strokes already judged stay judged.
  Status Learn(std::int64_t first, std::int64_t last, double wall, const AlarmUser& user);
  /// For the live service, which says it anew after a restart. Idle suppresses what is not active yet: a
  /// fault found in production stands through the break.
  Status SetSuppression(Suppression reason, bool on, double wall);
  /// Alarms of this axis whose cause the whole press shares; an alarm of the press stands for them.
  Status SetCommonCause(std::set<std::string> alarms, double wall);
  /// An alarm that something else than strokes raises; `condition` empty clears it.
  Status Observe(const std::string& alarm, const AlarmSettings& settings,
                 const std::optional<AlarmCondition>& condition, double wall);
  /// Ends shelves whose time is over.
  Status Tick(double wall);

  /// nullptr while commissioning. Valid after CatchUp().
  const drift::DriftMonitor* monitor() const { return monitor_ ? &*monitor_ : nullptr; }
  /// Why strokes of commissioning were not learned; "" once others are, or if nothing speaks against them.
  const Told& why_not_learned() const { return why_not_learned_; }
  /// Strokes commissioning has so far, and how many it needs: as counted here, else as the journal has it from who judged last.
  std::int64_t commissioning_strokes() const {
    return recorded_ ? recorded_->strokes : static_cast<std::int64_t>(collected_.size());
  }
  std::int64_t commissioning_needed() const { return recorded_ ? recorded_->needed : rules_.commissioning; }
  /// Both are from the journal, whatever rules this object was given.
  bool commissioning_recorded() const { return recorded_.has_value(); }
  const std::vector<AlarmState>& alarms() const { return alarms_; }
  /// What stood when, since the journal was begun.
  const FindingHistory& history() const { return history_; }
  const std::string& name() const { return machine_.name; }
  CountedWords counted() const { return CountedWordsOf(machine_); }
  /// First stroke not judged yet.
  std::int64_t next_stroke() const { return next_; }
  /// A stroke against the reference in force, whatever was said when it came.
  struct JudgedValue {
    std::int64_t sequence = 0;
    double oil_temperature = 0;  ///< K
    drift::Deviation deviation;
  };
  /// Of stored strokes first ... first + count - 1; empty while commissioning.
  Result<std::vector<JudgedValue>> JudgedValues(std::int64_t first, std::int64_t count) const;
  /// How its estimates are stated, as of what is stored now (StateEstimates). Reads and fits some hundred strokes.
  Result<std::vector<EstimateStatement>> Statements() const;
  /// Strokes after which it is worth asking anew: it rests on hundreds of them.
  static constexpr std::int64_t kStrokesPerStatement = 100;
  /// By its alarms and by what can be judged; troubles of the service are not known here.
  hydroscope::Health JudgedHealth() const;
  /// NAMUR NE 107.
  char Health() const { return JudgedHealth().letter(); }

 private:
  struct Stored {
    StrokeRecord record;
    std::int64_t sequence = 0;
    int model_version = 0;
  };
  static constexpr std::int64_t kStrokesPerChange = 256;  ///< strokes per transaction
  Result<std::vector<Stored>> Load(std::int64_t first, std::int64_t count) const;
  Result<std::vector<Stored>> LoadWithoutGrams(std::int64_t first, std::int64_t count) const;
  Result<std::vector<drift::StrokeEvidence>> LoadLearnable(std::int64_t first, std::int64_t count) const;
  drift::StrokeEvidence EvidenceOf(const Stored& stroke) const;
  bool Learnable(const drift::StrokeEvidence& evidence) const;
  Status Refresh();
  void Restore(const AxisContent& content);
  bool RestoreState();
  void Forget();
  std::vector<std::uint8_t> SaveState() const;
  Status BeginAnew(double wall);
  Result<std::optional<drift::Reference>> FrozenReference(AxisContent& learned_anew) const;
  void AppendReference(const drift::Reference& reference, const std::vector<drift::StrokeEvidence>& strokes,
                       const AlarmUser& user, AxisContent& content) const;
  /// Changes this axis in the journal, with the state as it then is in memory.
  Status Change(double wall, const std::function<void(AxisContent&)>& change);
  AlarmMoment Moment(double wall) const;
  Result<bool> CollectForLearning();
  Status CountNotJudged();
  bool RefuseCollected();
  Result<bool> Commission(double wall);
  Status JudgeWithoutReference(std::int64_t end, double wall);
  bool IsOfLimit(const AlarmState& alarm) const;
  Status LearnFrom(std::vector<drift::StrokeEvidence> strokes, std::int64_t next, double wall,
                   const AlarmUser& user);
  Status JudgeStrokes(double wall);
  bool ExplanationIsDue(const drift::DriftFinding& finding) const;
  bool AnyExplanationIsDue() const;
  drift::Judgement JudgeInSilence(const Stored& stroke, double wall);
  void Judge(const Stored& stroke, double wall, AxisContent& content);
  drift::DriftFinding JudgeInSilence(const ValveCheckRecord& check);
  Status JudgeValveChecks(double wall);
  Status ExplainFindings(double wall);
  void Suppress(AxisContent& content, const AlarmMoment& now);

  const Machine& machine_;
  std::shared_ptr<const ModelStructure> structure_;
  std::vector<EstimateStatement>
      tolerances_;  ///< limits are absolute: what all strokes share makes them uncertain
  const drift::RuleBook& rules_;
  const Database& database_;
  std::string path_;
  std::int64_t machine_id_;
  AlarmJournal& journal_;
  Result<drift::WatchedModel> model_;
  int columns_;
  std::optional<drift::DriftMonitor> monitor_;
  FindingHistory history_;
  drift::ValveCheckMonitor valve_;
  std::int64_t checks_ = 0;                         ///< valve checks judged
  std::int64_t next_ = 0;                           ///< first stroke not judged yet
  std::int64_t without_reference_to_ = 0;           ///< or, where it is later, that by limits and signals
  std::optional<std::vector<std::uint8_t>> saved_;  ///< state in the journal that memory stands for
  AlarmJournal::Version seen_;                      ///< of the journal when it was read last
  bool unreadable_ = false;                         ///< that state could not be read
  AlarmMoment last_;                                ///< of the last stroke judged
  std::int64_t waiting_ = 0;  ///< stored strokes that nobody had judged when Look() looked
  int not_judged_ = 0;        ///< strokes in a row that could not be judged, up to the last
  drift::JudgementReason why_not_judged_ = drift::JudgementReason::kJudged;
  std::vector<drift::StrokeEvidence> collected_;  ///< by commissioning
  std::int64_t collected_to_ = 0;                 ///< first stroke not looked at by commissioning
  struct Commissioning {
    std::int64_t strokes = 0, needed = 0;
  };
  std::optional<Commissioning> recorded_;  ///< from the journal, until it is counted here
  Told why_not_learned_;                   ///< what commissioning collected last was refused, and why
  std::uint8_t suppressed_ = 0;            ///< by SetSuppression()
  /// By SetCommonCause(); until it is called alarms stay as the journal has them.
  std::optional<std::set<std::string>> common_cause_;
  std::vector<AlarmState> alarms_;
};

}  // namespace hydroscope
