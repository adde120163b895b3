#pragma once

#include <string>
#include <vector>

#include "alarms/alarm_machine.h"
#include "core/records/estimate_statement.h"
#include "core/records/stroke_record.h"
#include "diagnosis/drift/drift_monitor.h"
#include "diagnosis/drift/rules.h"
#include "models/machine.h"
#include "monitor/learning_check.h"
#include "storage/alarm_journal.h"

namespace hydroscope {

/// Delays and deadband of the rules file.
AlarmSettings AlarmSettingsOf(const drift::RuleBook& rules);

/// Id of the alarm a finding raises: that of its rule, or "unnamed_change_<quantity>".
std::string AlarmIdOf(const drift::DriftFinding& finding);

/// Parameters and effects that the finding says have moved, the most evident first.
std::vector<std::string> QuantitiesOf(const drift::DriftFinding& finding);

/// Whether the finding is what its alarm tells: the first of those that raise it and stand. A later one about
/// the same quantities only corrects their size.
bool SpeaksForItsAlarm(const drift::DriftFinding& finding, const std::vector<drift::DriftFinding>& findings);

/// What was measured, what comparing strokes before and after said, what to do.
AlarmWords WordsOf(const drift::DriftFinding& finding, const drift::CountedIn& counted = {});
/// The same and the cause, as far as that comparison carries it, in one line: the alarm's text.
std::string AlarmTextOf(const drift::DriftFinding& finding, const drift::CountedIn& counted = {});

/// The stroke a judgement is about, as far as alarms need it.
struct JudgedRecord {
  const StrokeRecord& record;
  std::int64_t sequence;
  drift::JudgementReason reason;
};

/// From what is known after a stroke to the alarms of docs/alarms.md: each function observes its alarms once.
namespace axis_alarms {

void JudgeFindings(const drift::DriftMonitor& monitor, const drift::RuleBook& rules, const AlarmMoment& now,
                   AxisContent& content);
/// Clears what findings raised that a monitor begun anew does not find any more.
void ClearWhatIsGone(const drift::DriftMonitor& monitor, const drift::RuleBook& rules, const AlarmMoment& now,
                     AxisContent& content);
void JudgeSlowDrifts(const drift::DriftMonitor& monitor, const drift::RuleBook& rules, const AlarmMoment& now,
                     AxisContent& content);
/// Limits that the machine file states for the identified values as they are, at any temperature. `tolerances`: what all strokes
/// share; it makes uncertain on which side of a limit a value is, and is told, but neither raises nor clears.
void JudgeLimits(const MachineKind& kind, const std::vector<MonitorSpec>& monitors,
                 const std::vector<EstimateStatement>& tolerances, const drift::RuleBook& rules,
                 const JudgedRecord& stroke, const AlarmMoment& now, AxisContent& content);
/// Strokes of which less than half of the rows could be used, or whose signals count the other way round (ReversedIn).
void JudgeSignals(const Machine& machine, const JudgedRecord& stroke, const AlarmMoment& now,
                  AxisContent& content);
/// `doubtful_reference`: the strokes just learned do not look like those of a healthy machine.
void JudgeReference(int version, const std::vector<LearningDoubt>& doubts, const AlarmMoment& now,
                    AxisContent& content);
/// What a valve check found; one that found nothing clears what the last one raised.
void JudgeValveCheck(const drift::DriftFinding& finding, const drift::RuleBook& rules, const AlarmMoment& now,
                     AxisContent& content);

}  // namespace axis_alarms
}  // namespace hydroscope
