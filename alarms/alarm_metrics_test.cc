#include "alarms/alarm_metrics.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

JournalRow Raised(double wall, const std::string& alarm) {
  JournalRow row;
  row.machine = "press";
  row.wall = wall;
  row.event.alarm = alarm;
  row.event.event = "raised";
  return row;
}

TEST(AlarmMetrics, CountsRateFloodsAndChattering) {
  std::vector<JournalRow> rows;
  for (int k = 0; k < 12; ++k) rows.push_back(Raised(k * 30.0, "a" + std::to_string(k)));
  rows.push_back(Raised(3580, "b"));
  rows.push_back(Raised(3590, "b"));
  rows.push_back(Raised(3600, "b"));
  const AlarmMetrics m = MeasureAlarms(rows, {}, 3600);
  EXPECT_EQ(m.annunciations, 15);
  EXPECT_DOUBLE_EQ(m.hours, 1);
  EXPECT_EQ(m.most_in_10_minutes, 12);
  EXPECT_EQ(m.floods, 1);
  ASSERT_EQ(m.chattering.size(), 1u);
  EXPECT_EQ(m.chattering[0], "press/b");
  EXPECT_EQ(m.top.front(), (std::pair<std::string, std::int64_t>("press/b", 3)));
}

TEST(AlarmMetrics, CallsAlarmsActiveForMoreThanADayStale) {
  AlarmState old, fresh;
  old.id = "old";
  old.active = fresh.active = true;
  fresh.raised_wall = 80'000;
  EXPECT_EQ(MeasureAlarms({}, std::vector{old, fresh}, 90'000).stale, std::vector<std::string>{"old"});
}

}  // namespace
}  // namespace hydroscope
