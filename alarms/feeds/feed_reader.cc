#include "alarms/feeds/feed_reader.h"

#include <algorithm>
#include <filesystem>

#include "alarms/alarm_machine.h"

namespace hydroscope {

template <typename Use>
auto FeedReader::WithJournal(Use&& use) -> decltype(use(std::declval<AlarmJournal&>())) {
  if (!journal_) {
    auto opened = AlarmJournal::Open(AlarmJournal::PathFor(database_path_));
    if (!opened) return tl::unexpected(opened.error());
    journal_ = std::move(*opened);
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
    AxisPicture axis;
    axis.machine = machine;
    axis.name = machine.substr(machine.rfind('/') + 1);
    auto content = WithJournal([&](AlarmJournal& journal) { return journal.Axis(machine); });
    if (!content) return tl::unexpected(content.error());
    axis.health = NamurStatus(content->alarms, content->monitor.state.empty());
    axis.alarms = std::move(content->alarms);
    if (const Status read = ReadTrends(axis); !read) {
      database_.reset();
      return tl::unexpected(read.error());
    }
    axes.push_back(std::move(axis));
  }
  if (press_.empty()) return axes;
  auto content = WithJournal([&](AlarmJournal& journal) { return journal.Axis(press_); });
  if (!content) return tl::unexpected(content.error());
  if (content->alarms.empty()) return axes;
  AxisPicture press{.machine = press_, .name = press_, .alarms = std::move(content->alarms), .estimates = {}};
  press.health = NamurStatus(press.alarms, false);
  axes.push_back(std::move(press));
  return axes;
}

/// Estimates of the newest stroke; a database or a machine that is not there yet has none.
Status FeedReader::ReadTrends(AxisPicture& axis) {
  if (!database_) {
    std::error_code ignored;
    if (!std::filesystem::exists(database_path_, ignored)) return {};
    auto opened = Database::OpenReadOnly(database_path_);
    if (!opened) return tl::unexpected(opened.error());
    database_ = std::move(*opened);
  }
  const auto names = database_->MachineNames();
  if (!names) return tl::unexpected(names.error());
  if (std::find(names->begin(), names->end(), axis.machine) == names->end()) return {};
  const auto id = database_->MachineId(axis.machine);
  if (!id) return tl::unexpected(id.error());
  const auto end = database_->EndSequence(*id);
  if (!end) return tl::unexpected(end.error());
  axis.strokes = *end;
  if (*end == 0) return {};
  auto trend = database_->Trend(*id, "", *end - 1);
  if (!trend) return tl::unexpected(trend.error());
  for (TrendPoint& point : *trend)
    if (point.sequence == *end - 1) axis.estimates.push_back(std::move(point));
  return {};
}

Result<bool> FeedReader::Acknowledge(const std::string& machine, const std::string& alarm,
                                     const std::string& user, double wall) {
  return WithJournal([&](AlarmJournal& journal) -> Result<bool> {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    bool changed = false;
    const Status stored = journal.Change(machine, wall, [&](AxisContent& axis) -> Status {
      AlarmState& state = axis.Alarm(alarm);
      const AlarmMoment now{kUnknown, wall, state.last_stroke, kUnknown, 0, 0};
      auto events = alarm_machine::Acknowledge(state, {user, ""}, now);
      changed = !events.empty();
      axis.Append(std::move(events));
      return {};
    });
    if (!stored) return tl::unexpected(stored.error());
    return changed;
  });
}

int FeedReader::AxisNumber(const std::string& machine) const {
  if (!press_.empty() && machine == press_) return static_cast<int>(machines_.size()) + 1;
  const auto found = std::find(machines_.begin(), machines_.end(), machine);
  return found == machines_.end() ? 0 : static_cast<int>(found - machines_.begin()) + 1;
}

}  // namespace hydroscope
