#include "monitor/press_monitor.h"

#include <algorithm>

#include "core/constants.h"
#include "host/real_clock.h"
#include "monitor/rules_for.h"
#include "storage/journal_pairing.h"

namespace hydroscope {
namespace {

/// What a rule about several axes raises is on or off at once: the findings below it have been settled.
constexpr AlarmSettings kToldAtOnce{1, 1, 0, false};

/// Strokes at which the alarm was raised so far.
std::vector<std::int64_t> RaisedAt(const std::vector<JournalRow>& rows, const std::string& alarm) {
  std::vector<std::int64_t> strokes;
  for (const JournalRow& row : rows)
    if (row.event.alarm == alarm && row.event.event == "raised") strokes.push_back(row.event.stroke);
  return strokes;
}

bool IsTold(const CommonCause& cause, const std::vector<std::int64_t>& raised) {
  return std::ranges::any_of(raised,
                             [&](std::int64_t stroke) { return cause.from <= stroke && stroke < cause.to; });
}

std::vector<std::pair<std::int64_t, std::int64_t>> ExtentsOf(const std::vector<CommonCause>& causes) {
  std::vector<std::pair<std::int64_t, std::int64_t>> extents;
  for (const CommonCause& cause : causes) extents.emplace_back(cause.from, cause.to);
  return extents;
}

AlarmMoment MomentOf(std::int64_t stroke, double time, double wall) {
  AlarmMoment moment;
  moment.stroke = stroke;
  moment.time = time;
  moment.wall = wall;
  return moment;
}

}  // namespace

Result<std::unique_ptr<PressMonitor>> PressMonitor::Create(const std::string& machine_file,
                                                           const std::string& name, std::vector<Machine> axes,
                                                           const std::string& database) {
  auto opened = TRY(Database::Open(database));
  const auto set_aside = TRY(PairJournal(opened, database, name, WallSeconds()));
  auto rules = TRY(RulesFor(machine_file, axes.empty() ? Machine{} : axes.front()));
  auto journal = TRY(AlarmJournal::Open(AlarmJournal::PathFor(database)));
  std::unique_ptr<PressMonitor> press(
      new PressMonitor(name, std::move(rules), std::move(axes), std::move(opened), std::move(journal)));
  if (set_aside) press->notices_.push_back({"journal_set_aside", SetAsideText(*set_aside)});
  TRY(press->OpenAxes(database));
  return press;
}

Status PressMonitor::OpenAxes(const std::string& database) {
  for (const Machine& machine : machines_) {
    const auto model = TRY(BuildModel(machine));
    const auto id = TRY(database_.MachineId(machine.name));
    if (axes_.empty())
      for (std::string& remark : RuleRemarks(rules_, *model))
        notices_.push_back({"rules_do_not_fit", std::move(remark)});
    axes_.push_back(std::make_unique<AxisMonitor>(machine, model, rules_, database_, database, id, journal_));
  }
  return {};
}

Status PressMonitor::watchable() const {
  for (const auto& axis : axes_) TRY(axis->watchable());
  return {};
}

const AxisMonitor* PressMonitor::Find(const std::string& machine) const {
  for (const auto& axis : axes_)
    if (axis->name() == machine) return axis.get();
  return nullptr;
}

Status PressMonitor::CatchUp(double wall) {
  const Seen now{TRY(database_.CountStored()), TRY(journal_.CurrentVersion())};
  if (now == caught_up_to_) return {};
  for (const auto& axis : axes_) TRY(axis->CatchUp(wall));
  if (axes_.size() > 1) TRY(JudgeTogether(wall));
  caught_up_to_ = now;
  return {};
}

Status PressMonitor::Tick(double wall) {
  for (const auto& axis : axes_) TRY(axis->Tick(wall));
  const bool due = std::ranges::any_of(
      alarms_, [&](const AlarmState& alarm) { return alarm.shelved_until && wall >= *alarm.shelved_until; });
  if (!due) return {};
  return journal_.Change(name_, wall, [&](AxisContent& press) -> Status {
    for (AlarmState& alarm : press.alarms) press.Append(alarm_machine::Tick(alarm, MomentOf(-1, kNaN, wall)));
    alarms_ = press.alarms;
    return {};
  });
}

Status PressMonitor::JudgeTogether(double wall) {
  std::vector<const FindingHistory*> histories;
  for (const auto& axis : axes_) histories.push_back(&axis->history());
  std::vector<std::set<std::string>> common(axes_.size());
  for (const drift::Rule& rule : rules_.rules) {
    if (rule.axes < 2) continue;
    const std::vector<CommonCause> causes = CommonCauses(rule, histories);
    TRY(TellPress(rule, causes, wall));
    if (causes.empty() || !causes.back().StillStands()) continue;
    for (const CommonCause::Member& member : causes.back().members)
      common[member.axis].insert(member.finding.alarm);
  }
  for (std::size_t a = 0; a < axes_.size(); ++a) TRY(axes_[a]->SetCommonCause(std::move(common[a]), wall));
  return {};
}

AlarmCondition PressMonitor::ConditionOf(const drift::Rule& rule, const CommonCause& cause) const {
  std::vector<Told> axes;
  for (const CommonCause::Member& m : cause.members)
    axes.push_back(Tell("{} since {} {}", "{} seit {} {}", axis(m.axis).name(), axis(m.axis).counted().One(),
                        m.finding.since));
  AlarmCondition condition;
  condition.value = static_cast<double>(cause.members.size());
  condition.limit = rule.axes;
  condition.unit = "1";
  condition.severity = static_cast<AlarmSeverity>(rule.severity);
  condition.words = {rule.name, Joined(axes), rule.guidance};
  condition.text = Tell("{}: {}. {}", "{}: {}. {}", rule.name, Joined(axes), rule.guidance).english;
  condition.first_stroke = cause.members.front().finding.since;
  condition.last_stroke = cause.members.back().finding.since;
  return condition;
}

/// Raises and clears the press's alarm of a rule until the journal tells what stood together, also what came
/// and went before the last axis was judged. Nothing is read or written while nothing changes.
Status PressMonitor::TellPress(const drift::Rule& rule, const std::vector<CommonCause>& causes, double wall) {
  const auto content = TRY(journal_.Axis(name_));
  alarms_ = content.alarms;
  const auto known = std::ranges::find_if(alarms_, [&](const auto& a) { return a.id == rule.id; });
  const bool active = known != alarms_.end() && known->active;
  const bool stands = !causes.empty() && causes.back().StillStands();
  if (active == stands && (stands || told_[rule.id] == ExtentsOf(causes))) return {};
  const auto rows = TRY(journal_.Rows(name_));
  const std::vector<std::int64_t> raised = RaisedAt(rows, rule.id);
  const Status stored = journal_.Change(name_, wall, [&](AxisContent& press) -> Status {
    AlarmState& alarm = press.Alarm(rule.id);
    for (const CommonCause& cause : causes) {
      const bool is_told = IsTold(cause, raised), last = &cause == &causes.back();
      if (is_told && !last) continue;
      if (!is_told || cause.StillStands())
        press.Append(alarm_machine::Observe(alarm, kToldAtOnce, ConditionOf(rule, cause),
                                            MomentOf(cause.from, cause.from_time, wall)));
      if (!cause.StillStands())
        press.Append(alarm_machine::Clear(alarm, kToldAtOnce, MomentOf(cause.to, cause.to_time, wall)));
    }
    if (causes.empty()) press.Append(alarm_machine::Clear(alarm, kToldAtOnce, MomentOf(-1, kNaN, wall)));
    alarms_ = press.alarms;
    return {};
  });
  if (stored) told_[rule.id] = ExtentsOf(causes);
  return stored;
}

}  // namespace hydroscope
