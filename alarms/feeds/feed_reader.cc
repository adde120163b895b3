#include "alarms/feeds/feed_reader.h"

#include <algorithm>
#include <filesystem>

#include "alarms/alarm_action.h"
#include "alarms/press_health.h"
#include "core/contains.h"

namespace hydroscope {

template <typename Use>
auto FeedReader::WithJournal(Use&& use) -> decltype(use(std::declval<AlarmJournal&>())) {
  if (!journal_) {
    journal_ = TRY(AlarmJournal::Open(AlarmJournal::PathFor(database_path_)));
  }
  auto result = use(*journal_);
  if (!result) journal_.reset();
  return result;
}

Result<std::vector<std::pair<std::string, std::string>>> FeedReader::AlarmsByAppearance() {
  return WithJournal([](AlarmJournal& journal) { return journal.AlarmsByAppearance(); });
}

Result<std::int64_t> FeedReader::LastSequence() {
  return WithJournal([](AlarmJournal& journal) { return journal.LastSequence(); });
}

Result<std::vector<JournalRow>> FeedReader::Rows(std::int64_t after, std::int64_t limit) {
  return WithJournal([&](AlarmJournal& journal) { return journal.Rows("", after, limit); });
}

Result<std::vector<AxisPicture>> FeedReader::Axes() {
  std::vector<AxisPicture> axes;
  for (const std::string& machine : machines_) {
    auto axis = ReadAxis(machine);
    if (!axis && !board_) return tl::unexpected(axis.error());
    axes.push_back(axis ? seen_[machine] = std::move(*axis) : seen_[machine]);
    axes.back().machine = machine;
    axes.back().name = machine.substr(machine.rfind('/') + 1);
    if (!board_) continue;
    axes.back().health = board_->Of(machine);
    const auto statements = board_->StatementsOf(machine);
    for (TrendPoint& point : axes.back().estimates) StateEstimate(statements, point.estimate);
  }
  if (press_.empty()) return axes;
  auto press = ReadPress();
  if (!press && !board_) return tl::unexpected(press.error());
  if (press && *press) seen_[press_] = std::move(**press);
  const auto known = seen_.find(press_);
  if (known == seen_.end()) return axes;
  std::vector<Health> healths;
  for (const AxisPicture& axis : axes) healths.push_back(axis.health);
  axes.push_back(known->second);
  axes.back().health = JudgePressHealth(known->second.alarms, trouble(), healths);
  return axes;
}

Result<AxisPicture> FeedReader::ReadAxis(const std::string& machine) {
  AxisPicture axis;
  axis.machine = machine;
  auto content = TRY(WithJournal([&](AlarmJournal& journal) { return journal.Axis(machine); }));
  axis.health = JudgeHealth(
      {.alarms = content.alarms, .has_reference = content.monitor.judges(), .not_judged = {}, .trouble = {}});
  axis.alarms = std::move(content.alarms);
  if (const Status read = ReadTrends(axis); !read) {
    database_.reset();
    if (!board_) return tl::unexpected(read.error());
    axis.strokes = seen_[machine].strokes;
    axis.estimates = seen_[machine].estimates;
  }
  return axis;
}

/// nullopt: it never had an alarm.
Result<std::optional<AxisPicture>> FeedReader::ReadPress() {
  auto content = TRY(WithJournal([&](AlarmJournal& journal) { return journal.Axis(press_); }));
  if (content.alarms.empty()) return std::nullopt;
  AxisPicture press;
  press.machine = press.name = press_;
  press.alarms = std::move(content.alarms);
  return press;
}

/// Estimates of the newest stroke; a database or a machine that is not there yet has none.
Status FeedReader::ReadTrends(AxisPicture& axis) {
  if (!database_) {
    std::error_code ignored;
    if (!std::filesystem::exists(database_path_, ignored)) return {};
    database_ = TRY(Database::OpenReadOnly(database_path_));
  }
  const auto names = TRY(database_->MachineNames());
  if (!Contains(names, axis.machine)) return {};
  const auto id = TRY(database_->MachineId(axis.machine));
  const auto end = TRY(database_->EndSequence(id));
  axis.strokes = end;
  if (end == 0) return {};
  auto trend = TRY(database_->Trend(id, "", end - 1));
  for (TrendPoint& point : trend)
    if (point.sequence == end - 1) axis.estimates.push_back(std::move(point));
  return {};
}

Result<bool> FeedReader::Acknowledge(const std::string& machine, const std::string& alarm,
                                     const AlarmUser& user, double wall) {
  return WithJournal([&](AlarmJournal& journal) {
    return ActOnAlarm(journal, machine, alarm, wall, [&](AlarmState& state, const AlarmMoment& now) {
      return alarm_machine::Acknowledge(state, user, now);
    });
  });
}

int FeedReader::AxisNumber(const std::string& machine) const {
  if (!press_.empty() && machine == press_) return static_cast<int>(machines_.size()) + 1;
  const auto found = std::ranges::find(machines_, machine);
  return found == machines_.end() ? 0 : static_cast<int>(found - machines_.begin()) + 1;
}

}  // namespace hydroscope
