#include "alarms/alarm_metrics.h"

#include <algorithm>
#include <deque>
#include <map>
#include <set>

namespace hydroscope {
namespace {

constexpr double kTenMinutes = 600, kMinute = 60, kHour = 3600, kDay = 86400;  ///< s
constexpr std::size_t kFlood = 10, kChatter = 3, kTop = 10;

}  // namespace

AlarmMetrics MeasureAlarms(std::span<const JournalRow> rows, std::span<const AlarmState> states, double now) {
  AlarmMetrics metrics;
  std::deque<double> recent;
  std::map<std::string, std::deque<double>> by_source;
  std::map<std::string, std::int64_t> counts;
  std::set<std::string> chattering;
  bool flood = false;
  for (const JournalRow& row : rows) {
    if (row.event.event != "raised") continue;
    const std::string source = row.machine + "/" + row.event.alarm;
    ++metrics.annunciations;
    ++counts[source];
    recent.push_back(row.wall);
    while (recent.front() <= row.wall - kTenMinutes) recent.pop_front();
    metrics.most_in_10_minutes = std::max(metrics.most_in_10_minutes, static_cast<int>(recent.size()));
    if (recent.size() > kFlood && !flood) ++metrics.floods;
    flood = recent.size() > kFlood;
    auto& own = by_source[source];
    own.push_back(row.wall);
    while (own.front() <= row.wall - kMinute) own.pop_front();
    if (own.size() >= kChatter) chattering.insert(source);
  }
  if (!rows.empty()) metrics.hours = (rows.back().wall - rows.front().wall) / kHour;
  if (metrics.hours > 0) metrics.per_hour = static_cast<double>(metrics.annunciations) / metrics.hours;
  metrics.chattering.assign(chattering.begin(), chattering.end());
  for (const AlarmState& state : states)
    if (state.active && now - state.raised_wall > kDay) metrics.stale.push_back(state.id);
  metrics.top.assign(counts.begin(), counts.end());
  std::ranges::stable_sort(metrics.top, [](const auto& a, const auto& b) { return a.second > b.second; });
  if (metrics.top.size() > kTop) metrics.top.resize(kTop);
  return metrics;
}

}  // namespace hydroscope
