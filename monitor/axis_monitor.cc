#include "monitor/axis_monitor.h"

#include <algorithm>

#include "core/constants.h"
#include "core/told_error.h"
#include "models/closed_loop.h"
#include "models/machine_kind.h"
#include "monitor/axis_alarms.h"
#include "monitor/finding_explanation.h"
#include "pipeline/doubtful_estimates.h"
#include "pipeline/geometry_tolerance.h"
#include "workbench/history/stated_estimates.h"

namespace hydroscope {
namespace {

/// Strokes in a row without a judgement after which health says so: a minute or two of a press at work.
constexpr int kStrokesUntilNotJudged = 10;
constexpr std::int64_t kSlowDriftEvery = 50;  ///< strokes

std::vector<std::string> WatchedNames(const drift::RuleBook& rules) {
  std::vector<std::string> names;
  for (const drift::WatchSpec& watch : rules.watches) names.push_back(watch.quantity);
  return names;
}

/// First stroke that is surely behind the change.
std::int64_t FirstChanged(const drift::DriftFinding& finding) {
  return std::max(finding.since.last_before, finding.since.high) + 1;
}

}  // namespace

AxisMonitor::AxisMonitor(const Machine& machine, std::shared_ptr<const ModelStructure> model,
                         const drift::RuleBook& rules, const Database& database, std::string path,
                         std::int64_t machine_id, AlarmJournal& journal)
    : machine_(machine),
      structure_(model),
      rules_(rules),
      database_(database),
      path_(std::move(path)),
      machine_id_(machine_id),
      journal_(journal),
      model_(drift::WatchedModel::Create(model, WatchedNames(rules))),
      columns_(model->column_count()),
      valve_(rules) {
  last_.time = last_.oil_temperature = kNaN;
  if (!machine.monitors.empty()) tolerances_ = ToleranceStatements(machine, *structure_);
}

Result<std::vector<EstimateStatement>> AxisMonitor::Statements() const {
  const auto runs = TRY(database_.Runs(machine_id_));
  const auto end = TRY(database_.EndSequence(machine_id_));
  const auto trend =
      end == 0 ? std::vector<TrendPoint>{} : TRY(database_.Trend(machine_id_, "", end - 1, end));
  std::vector<Estimate> latest;
  for (const TrendPoint& point : trend) latest.push_back(point.estimate);
  auto stated = TRY(StateEstimates(database_, machine_id_, machine_, *structure_, runs, latest));
  return std::move(stated.statements);
}

hydroscope::Health AxisMonitor::JudgedHealth() const {
  const CountedWords counted = CountedWordsOf(machine_);
  Told not_judged;
  if (waiting_ > 0)
    not_judged =
        Tell("{} are stored that nobody has judged", "{} sind gespeichert, die niemand beurteilt hat",
             counted.CountedTold(static_cast<std::size_t>(waiting_)));
  else if (not_judged_ >= kStrokesUntilNotJudged)
    not_judged = drift::JudgementTold(why_not_judged_);
  return JudgeHealth({.alarms = alarms_,
                      .has_reference = monitor_.has_value(),
                      .learned = commissioning_strokes(),
                      .needed = commissioning_needed(),
                      .not_learned = why_not_learned_,
                      .not_judged = std::move(not_judged),
                      .counted = counted});
}

/// Strokes first ... first + count - 1 as far as they are stored, with Grams and estimates.
Result<std::vector<AxisMonitor::Stored>> AxisMonitor::Load(std::int64_t first, std::int64_t count) const {
  auto strokes = TRY(LoadWithoutGrams(first, count));
  if (strokes.empty()) return strokes;
  auto grams = TRY(database_.Grams(machine_id_, strokes.front().sequence, strokes.back().sequence + 1));
  for (std::size_t i = 0; i < strokes.size() && i < grams.size(); ++i)
    strokes[i].record.gram = std::move(grams[i]);
  return strokes;
}

Result<std::vector<AxisMonitor::Stored>> AxisMonitor::LoadWithoutGrams(std::int64_t first,
                                                                       std::int64_t count) const {
  std::vector<Stored> strokes;
  const auto stored_to = TRY(database_.EndSequence(machine_id_));
  if (stored_to <= first) return strokes;
  const auto runs = TRY(database_.Runs(machine_id_));
  for (const RunInfo& run : runs) {
    const std::int64_t begin = std::max(first, run.first_sequence);
    const std::int64_t end = std::min(first + count, run.first_sequence + run.strokes);
    if (begin >= end) continue;
    auto summaries = TRY(database_.SummariesOf(machine_id_, begin, end, end - begin));
    for (StrokeSummary& summary : summaries) {
      Stored stroke;
      stroke.sequence = summary.index;
      stroke.record.summary = std::move(summary);
      stroke.model_version = run.model_version;
      strokes.push_back(std::move(stroke));
    }
  }
  const bool asks_estimates = !machine_.monitors.empty() || ClosedLoopOf(machine_) != nullptr;
  if (strokes.empty() || !asks_estimates) return strokes;
  const auto trend =
      TRY(database_.Trend(machine_id_, "", strokes.front().sequence, strokes.back().sequence + 1));
  for (const TrendPoint& point : trend) {
    const auto index = static_cast<std::size_t>(point.sequence - strokes.front().sequence);
    if (index < strokes.size()) strokes[index].record.estimates.push_back(point.estimate);
  }
  return strokes;
}

drift::StrokeEvidence AxisMonitor::EvidenceOf(const Stored& stroke) const {
  // A Gram of another model's columns tells nothing here, nor does one of a signal that counts the other way round.
  if (stroke.record.gram.integral.dimension() == columns_ &&
      ReversedIn(machine_, stroke.record.estimates).empty())
    return model_->Evidence(stroke.record, stroke.sequence);
  drift::StrokeEvidence none;
  none.sequence = stroke.sequence;
  none.time = stroke.record.summary.end;
  none.oil_temperature = stroke.record.summary.oil_temperature;
  return none;
}

bool AxisMonitor::Learnable(const drift::StrokeEvidence& evidence) const {
  return !(evidence.oil_temperature < rules_.minimum_temperature) && evidence.equations.equations > 0;
}

Status AxisMonitor::Change(double wall, const std::function<void(AxisContent&)>& change) {
  std::vector<std::uint8_t> state;
  const Status stored = journal_.Change(machine_.name, wall, [&](AxisContent& axis) -> Status {
    if (axis.monitor.next_stroke != next_ || axis.monitor.state != *saved_)
      return InternalError("another process judges the strokes of {} at the same time", machine_.name);
    change(axis);
    state = unreadable_ ? *saved_ : SaveState();
    axis.monitor.next_stroke = next_;
    axis.monitor.state = state;
    alarms_ = axis.alarms;
    return {};
  });
  if (stored)
    saved_ = std::move(state);
  else
    saved_.reset();  // what is in memory is ahead of the file
  return stored;
}

AlarmMoment AxisMonitor::Moment(double wall) const {
  AlarmMoment now = last_;
  now.wall = wall;
  return now;
}

Status AxisMonitor::Look() {
  if (!model_) return tl::unexpected(model_.error());
  TRY(Refresh());
  if (unreadable_)
    return BadInput(Tell(
        "what is known of the healthy {} was written with other rules or by another version of the program; give the "
        "machine file whose rules lie beside it (--machine)",
        "was von der gesunden {} bekannt ist, wurde mit anderen Regeln oder einer anderen Version des Programms "
        "geschrieben; die Maschinendatei angeben, neben der seine Regeln liegen (--machine)",
        machine_.name));
  if (monitor_) return CountNotJudged();
  if (recorded_) return {};
  const auto collected = CollectForLearning();
  return collected ? Status{} : Status(tl::unexpected(collected.error()));
}

/// Looks anew whether the last strokes are and can be judged, which the journal does not keep.
Status AxisMonitor::CountNotJudged() {
  const auto stored_to = TRY(database_.EndSequence(machine_id_));
  waiting_ = std::max<std::int64_t>(0, stored_to - next_);
  not_judged_ = 0;
  const std::int64_t first = next_ - kStrokesUntilNotJudged;
  if (first <= monitor_->reference().last_sequence()) return {};
  const auto last = TRY(JudgedValues(first, kStrokesUntilNotJudged));
  if (std::ranges::any_of(last, [](const JudgedValue& v) { return v.deviation.judged; })) return {};
  not_judged_ = kStrokesUntilNotJudged;
  why_not_judged_ = last.empty() ? drift::JudgementReason::kTooCold : drift::JudgementReason::kNewClass;
  return {};
}

Status AxisMonitor::CatchUp(double wall) {
  if (!model_) return tl::unexpected(model_.error());
  TRY(Refresh());
  if (unreadable_) TRY(BeginAnew(wall));
  if (!monitor_) TRY(Commission(wall));
  if (!monitor_) {
    const auto stored_to = TRY(database_.EndSequence(machine_id_));
    TRY(JudgeWithoutReference(stored_to, wall));
  }
  if (monitor_) TRY(JudgeStrokes(wall));
  return JudgeValveChecks(wall);
}

/// Stops at each stroke at which an explanation is due, however many more are stored already.
Status AxisMonitor::JudgeStrokes(double wall) {
  for (;;) {
    TRY(ExplainFindings(wall));
    const auto strokes = TRY(Load(next_, kStrokesPerChange));
    if (strokes.empty()) return {};
    TRY(Change(wall, [&](AxisContent& axis) {
      for (const Stored& stroke : strokes) {
        Judge(stroke, wall, axis);
        axis.monitor.model_version = stroke.model_version;
        next_ = stroke.sequence + 1;
        if (AnyExplanationIsDue()) break;
      }
    }));
  }
}

/// Whether a finding has as many strokes behind it as its next explanation waits for.
bool AxisMonitor::ExplanationIsDue(const drift::DriftFinding& finding) const {
  if (finding.parts.empty() || finding.state == drift::FindingState::kGone || finding.compared.settled)
    return false;
  if (!SpeaksForItsAlarm(finding, monitor_->findings())) return false;
  const std::int64_t strokes = next_ - FirstChanged(finding);
  return std::ranges::any_of(kStrokesToExplain, [&](std::int64_t wanted) {
    return finding.explained < wanted && wanted <= strokes;
  });
}

bool AxisMonitor::AnyExplanationIsDue() const {
  const auto& findings = monitor_->findings();
  return std::ranges::any_of(findings, [&](const auto& f) { return ExplanationIsDue(f); });
}

Result<std::vector<AxisMonitor::JudgedValue>> AxisMonitor::JudgedValues(std::int64_t first,
                                                                        std::int64_t count) const {
  std::vector<JudgedValue> values;
  if (!monitor_) return values;
  for (std::int64_t from = first; from < first + count; from += kStrokesPerChange) {
    const auto strokes = TRY(Load(from, std::min(kStrokesPerChange, first + count - from)));
    for (const Stored& stroke : strokes) {
      const drift::StrokeEvidence evidence = EvidenceOf(stroke);
      if (Learnable(evidence))
        values.push_back(
            {stroke.sequence, evidence.oil_temperature, monitor_->reference().Judge(*model_, evidence)});
    }
  }
  return values;
}

Status AxisMonitor::SetSuppression(Suppression reason, bool on, double wall) {
  TRY(Refresh());
  suppressed_ = static_cast<std::uint8_t>(on ? suppressed_ | reason : suppressed_ & ~reason);
  return Change(wall, [&](AxisContent& axis) { Suppress(axis, Moment(wall)); });
}

Status AxisMonitor::SetCommonCause(std::set<std::string> alarms, double wall) {
  if (alarms == common_cause_) return {};
  TRY(Refresh());
  common_cause_ = std::move(alarms);
  return Change(wall, [&](AxisContent& axis) { Suppress(axis, Moment(wall)); });
}

/// Brings the flags of every alarm, new ones too, to what SetSuppression() and SetCommonCause() said last.
void AxisMonitor::Suppress(AxisContent& content, const AlarmMoment& now) {
  for (AlarmState& alarm : content.alarms) {
    // A link that is lost while the press rests is lost all the same.
    const bool idle = (suppressed_ & kSuppressedIdle) != 0 && alarm.severity != AlarmSeverity::kSignalLoss;
    if (!idle || !alarm.active) content.Append(alarm_machine::Suppress(alarm, kSuppressedIdle, idle, now));
    content.Append(alarm_machine::Suppress(alarm, kSuppressedValveCheck,
                                           (suppressed_ & kSuppressedValveCheck) != 0, now));
    if (common_cause_)
      content.Append(
          alarm_machine::Suppress(alarm, kSuppressedCommonCause, common_cause_->contains(alarm.id), now));
  }
}

Status AxisMonitor::Observe(const std::string& alarm, const AlarmSettings& settings,
                            const std::optional<AlarmCondition>& condition, double wall) {
  TRY(Refresh());
  const auto known = std::ranges::find_if(alarms_, [&](const auto& a) { return a.id == alarm; });
  if (!condition && (known == alarms_.end() || !known->active)) return {};
  return Change(wall, [&](AxisContent& axis) {
    const AlarmMoment now = Moment(wall);
    if (AlarmState& state = axis.Alarm(alarm); condition && !state.active)
      state.severity = condition->severity;
    Suppress(axis, now);
    AlarmState& state = axis.Alarm(alarm);
    axis.Append(condition ? alarm_machine::Observe(state, settings, *condition, now)
                          : alarm_machine::Clear(state, settings, now));
  });
}

Status AxisMonitor::Tick(double wall) {
  const bool due = std::ranges::any_of(
      alarms_, [&](const AlarmState& a) { return a.shelved_until && wall >= *a.shelved_until; });
  if (!due) return {};
  TRY(Refresh());
  return Change(wall, [&](AxisContent& axis) {
    for (AlarmState& alarm : axis.alarms) axis.Append(alarm_machine::Tick(alarm, Moment(wall)));
  });
}

/// What the monitor says to a stroke; no alarm hears of it.
drift::Judgement AxisMonitor::JudgeInSilence(const Stored& stroke, double wall) {
  const drift::StrokeEvidence evidence = EvidenceOf(stroke);
  drift::Judgement judgement = monitor_->Add(evidence);
  last_ = {evidence.time,        wall,
           stroke.sequence,      evidence.oil_temperature,
           stroke.model_version, monitor_->reference().version()};
  history_.Follow(monitor_->findings(), stroke.sequence, evidence.time);
  not_judged_ = judgement.reason == drift::JudgementReason::kJudged ? 0 : not_judged_ + 1;
  why_not_judged_ = judgement.reason;
  return judgement;
}

void AxisMonitor::Judge(const Stored& stroke, double wall, AxisContent& content) {
  const drift::Judgement judgement = JudgeInSilence(stroke, wall);
  const AlarmMoment now = last_;
  const JudgedRecord judged{stroke.record, stroke.sequence, judgement.reason};
  for (AlarmState& alarm : content.alarms) content.Append(alarm_machine::Tick(alarm, now));
  const bool first_time = stroke.sequence >= without_reference_to_;
  if (first_time) axis_alarms::JudgeSignals(machine_, judged, now, content);
  const bool cold = judgement.reason == drift::JudgementReason::kTooCold;
  for (AlarmState& alarm : content.alarms)
    if (alarm.severity != AlarmSeverity::kSignalLoss)
      content.Append(alarm_machine::Suppress(alarm, kSuppressedTooCold, cold, now));
  if (judgement.reason == drift::JudgementReason::kJudged) {
    axis_alarms::JudgeFindings(*monitor_, rules_, now, content);
    if (stroke.sequence % kSlowDriftEvery == 0) axis_alarms::JudgeSlowDrifts(*monitor_, rules_, now, content);
  }
  if (!cold && first_time && ReversedIn(machine_, stroke.record.estimates).empty())
    axis_alarms::JudgeLimits(KindOf(machine_), machine_.monitors, tolerances_, rules_, judged, now, content);
  Suppress(content, now);
}

/// Counts the check; a finding without parts if it found nothing.
drift::DriftFinding AxisMonitor::JudgeInSilence(const ValveCheckRecord& check) {
  ++checks_;
  if (check.outcome != "measured") return {};
  return valve_.Add(check.check, checks_);
}

/// Checks that measured the valve; refused and broken ones say nothing about it.
Status AxisMonitor::JudgeValveChecks(double wall) {
  const auto checks = TRY(database_.ValveChecks(machine_id_));
  if (static_cast<std::int64_t>(checks.size()) <= checks_) return {};
  return Change(wall, [&](AxisContent& axis) {
    while (checks_ < static_cast<std::int64_t>(checks.size())) {
      const ValveCheckRecord& record = checks[checks_];
      const drift::DriftFinding finding = JudgeInSilence(record);
      if (record.outcome != "measured") continue;
      AlarmMoment now = Moment(wall);
      now.time = record.check.time;
      now.oil_temperature = record.check.oil_temperature;
      axis_alarms::JudgeValveCheck(finding, rules_, now, axis);
    }
  });
}

/// New findings are compared with the strokes before; the answer becomes part of finding and alarm.
Status AxisMonitor::ExplainFindings(double wall) {
  const std::vector<drift::DriftFinding> findings = monitor_->findings();
  for (const drift::DriftFinding& finding : findings) {
    if (!ExplanationIsDue(finding)) continue;
    const std::int64_t changed = FirstChanged(finding);
    const drift::FindingExplanation explanation =
        ExplainFinding(database_, path_, machine_.name, machine_id_, finding,
                       monitor_->reference().first_sequence(), EndOfHealthy(finding, findings), next_);
    TRY(Change(wall, [&](AxisContent& axis) {
      monitor_->TakeExplanation(finding.number, explanation, next_ - changed);
      AlarmEvent event;
      event.alarm = AlarmIdOf(finding);
      event.event = "explained";
      event.severity = static_cast<AlarmSeverity>(finding.severity);
      event.time = last_.time;
      event.stroke = next_ - 1;
      event.oil_temperature = last_.oil_temperature;
      event.model_version = last_.model_version;
      event.reference_version = monitor_->reference().version();
      event.text = explanation.text.english;
      event.cause = CauseText(explanation.cause);
      event.first_stroke = changed;
      event.last_stroke = next_ - 1;
      AlarmState& alarm = axis.Alarm(event.alarm);
      drift::DriftFinding explained = finding;
      explained.compared = explanation;
      const drift::CountedIn counted = drift::CountedInOf(KindOf(machine_));
      alarm.text = AlarmTextOf(explained, counted);
      alarm.words = WordsOf(explained, counted);
      alarm.cause = explanation.cause;
      event.state_before = event.state = StateName(alarm);
      axis.events.push_back(std::move(event));
    }));
  }
  return {};
}

}  // namespace hydroscope
