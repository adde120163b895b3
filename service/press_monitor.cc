#include "service/press_monitor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "service/axis_alarms.h"

namespace hydroscope {
namespace {

bool Stands(const drift::DriftFinding& f) {
  return f.state == drift::FindingState::kNamed && !f.parts.empty();
}

std::map<std::string, int> MovementsOf(const drift::DriftFinding& finding) {
  std::map<std::string, int> movements;
  for (const drift::FindingPart& part : finding.parts) movements[part.quantity] = part.size > 0 ? 1 : -1;
  return movements;
}

/// What a rule about several axes raises is on or off at once: the findings below it have had their delays.
constexpr AlarmSettings kAtOnce{1, 1, 0, false};

}  // namespace

Result<std::unique_ptr<PressMonitor>> PressMonitor::Create(const std::string& machine_file,
                                                           const Machine& machine,
                                                           const std::string& database) {
  auto rules = RulesFor(machine_file);
  if (!rules) return tl::unexpected(rules.error());
  auto opened = Database::Open(database);
  if (!opened) return tl::unexpected(opened.error());
  auto journal = AlarmJournal::Open(AlarmJournal::PathFor(database));
  if (!journal) return tl::unexpected(journal.error());
  const auto model = BuildModel(machine);
  if (!model) return tl::unexpected(model.error());
  std::unique_ptr<PressMonitor> press(
      new PressMonitor(machine.name, std::move(*rules), std::move(*opened), std::move(*journal)));
  const int count = AxisCount(machine);
  for (int a = 0; a < count; ++a) {
    press->machines_.push_back(machine);
    press->machines_.back().name = AxisMachineName(machine, a);
  }
  for (const Machine& axis : press->machines_) {
    const auto id = press->database_.MachineId(axis.name);
    if (!id) return tl::unexpected(id.error());
    press->axes_.push_back(std::make_unique<AxisMonitor>(axis, *model, press->rules_, press->database_,
                                                         database, *id, press->journal_));
    if (const Status watchable = press->axes_.back()->watchable(); !watchable)
      return tl::unexpected(watchable.error());
  }
  return press;
}

Status PressMonitor::CatchUp(double wall) {
  for (const auto& axis : axes_)
    if (const Status done = axis->CatchUp(wall); !done) return done;
  return JudgeTogether(wall);
}

Status PressMonitor::Tick(double wall) {
  for (const auto& axis : axes_)
    if (const Status done = axis->Tick(wall); !done) return done;
  return {};
}

/// The largest group of axes whose findings match the rule and began within its number of strokes.
std::vector<PressMonitor::Member> PressMonitor::Together(const drift::Rule& rule) const {
  std::vector<Member> members;
  for (int a = 0; a < axis_count(); ++a) {
    if (axis(a).monitor() == nullptr) continue;
    for (const drift::DriftFinding& finding : axis(a).monitor()->findings()) {
      if (!Stands(finding) || !rule.Matches(MovementsOf(finding))) continue;
      members.push_back({a, finding.since.last_before + 1, AlarmIdOf(finding)});
      break;
    }
  }
  std::sort(members.begin(), members.end(),
            [](const Member& x, const Member& y) { return x.since < y.since; });
  std::size_t best = 0, length = 0;
  for (std::size_t i = 0, j = 0; i < members.size(); ++i) {
    while (j < members.size() && members[j].since - members[i].since <= rule.within) ++j;
    if (j - i > length) {
      best = i;
      length = j - i;
    }
  }
  if (static_cast<int>(length) < rule.axes) return {};
  return {members.begin() + static_cast<std::ptrdiff_t>(best),
          members.begin() + static_cast<std::ptrdiff_t>(best + length)};
}

Status PressMonitor::JudgeTogether(double wall) {
  std::vector<std::set<std::string>> common(axes_.size());
  for (const drift::Rule& rule : rules_.rules) {
    if (rule.axes < 2) continue;
    const std::vector<Member> members = Together(rule);
    for (const Member& m : members) common[static_cast<std::size_t>(m.axis)].insert(m.alarm);
    if (const Status told = TellPress(rule, members, wall); !told) return told;
  }
  for (std::size_t a = 0; a < axes_.size(); ++a)
    if (const Status set = axes_[a]->SetCommonCause(std::move(common[a]), wall); !set) return set;
  return {};
}

/// Raises or clears the press's alarm of a rule; nothing is written while nothing changes.
Status PressMonitor::TellPress(const drift::Rule& rule, const std::vector<Member>& members, double wall) {
  const auto content = journal_.Axis(name_);
  if (!content) return tl::unexpected(content.error());
  alarms_ = content->alarms;
  const auto known =
      std::find_if(alarms_.begin(), alarms_.end(), [&](const auto& a) { return a.id == rule.id; });
  const bool active = known != alarms_.end() && known->active;
  if (active == !members.empty()) return {};
  return journal_.Change(name_, wall, [&](AxisContent& press) -> Status {
    AlarmMoment now;
    now.wall = wall;
    AlarmState& alarm = press.Alarm(rule.id);
    if (members.empty()) {
      press.Append(alarm_machine::Clear(alarm, kAtOnce, now));
    } else {
      std::vector<std::string> names;
      for (const Member& m : members)
        names.push_back(fmt::format("{} since stroke {}", axis(m.axis).name(), m.since));
      now.stroke = members.back().since;
      AlarmCondition condition;
      condition.value = static_cast<double>(members.size());
      condition.limit = rule.axes;
      condition.unit = "1";
      condition.severity = static_cast<AlarmSeverity>(rule.severity);
      condition.text = fmt::format("{}: {}. {}", rule.name, fmt::join(names, ", "), rule.guidance);
      condition.first_stroke = members.front().since;
      condition.last_stroke = members.back().since;
      press.Append(alarm_machine::Observe(alarm, kAtOnce, condition, now));
    }
    alarms_ = press.alarms;
    return {};
  });
}

}  // namespace hydroscope
