#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>

#include "alarms/alarm_machine.h"
#include "alarms/feeds/feeds.h"
#include "core/clock.h"
#include "storage/alarm_journal.h"

namespace hydroscope {

/// A journal of a press with two axes, and feeds that read it.
class FeedTest : public testing::Test {
 protected:
  FeedTest() : folder_(testing::TempDir() + "/feeds_" + Name()) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    auto journal = AlarmJournal::Open(AlarmJournal::PathFor(database()));
    if (!journal) throw std::runtime_error(journal.error().text);
    journal_.emplace(std::move(*journal));
  }
  ~FeedTest() override { std::filesystem::remove_all(folder_); }

  static std::string Name() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }
  std::string database() const { return folder_ + "/press.db"; }
  std::string File(const std::string& name) const { return folder_ + "/" + name; }
  AlarmJournal& journal() { return *journal_; }

  static HostTime RealTime() {
    const auto monotonic = std::chrono::steady_clock::now().time_since_epoch();
    const auto wall = std::chrono::system_clock::now().time_since_epoch();
    return {std::chrono::duration_cast<std::chrono::nanoseconds>(monotonic).count(),
            std::chrono::duration_cast<std::chrono::nanoseconds>(wall).count()};
  }
  static double Now() { return static_cast<double>(RealTime().monotonic_ns) * 1e-9; }
  static bool WaitUntil(const std::function<bool()>& condition, double seconds = 10) {
    const double end = Now() + seconds;
    while (!condition()) {
      if (Now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  /// A press with axes "left" and "right" and these feeds.
  static Machine Press(PartsSpec feeds) {
    Machine machine;
    machine.name = "press";
    machine.live.emplace().axes = {"left", "right"};
    machine.feeds = std::move(feeds);
    return machine;
  }

  /// Raises alarms "alarm_<first>" ... of an axis in one transaction.
  void Raise(const std::string& axis, int first, int count = 1) {
    const double wall = static_cast<double>(RealTime().wall_ns) * 1e-9;
    const Status stored = journal().Change("press/" + axis, wall, [&](AxisContent& content) -> Status {
      content.monitor.state = {1};  // commissioned
      for (int k = first; k < first + count; ++k) {
        AlarmState& alarm = content.Alarm(fmt::format("alarm_{}", k));
        content.Append(
            alarm_machine::Observe(alarm, {.on_delay = 1},
                                   {.value = 2.0 * k,
                                    .std = 0.5,
                                    .limit = 1,
                                    .unit = "m3/s",
                                    .severity = AlarmSeverity::kAlarm,
                                    .text = "a \"seal\" leaks"},
                                   {.time = 10.0 * k, .wall = wall, .stroke = k, .oil_temperature = 313.15}));
      }
      return {};
    });
    ASSERT_TRUE(stored) << stored.error().text;
  }
  /// Raises an alarm of the press itself.
  void RaiseOfPress(const std::string& alarm) {
    const double wall = static_cast<double>(RealTime().wall_ns) * 1e-9;
    const Status stored = journal().Change("press", wall, [&](AxisContent& press) -> Status {
      press.Append(alarm_machine::Observe(press.Alarm(alarm), {.on_delay = 1},
                                          {.value = 2, .limit = 2, .unit = "1", .text = "both axes"},
                                          {.wall = wall, .stroke = 9}));
      return {};
    });
    ASSERT_TRUE(stored) << stored.error().text;
  }
  /// An axis whose healthy machine is being learned, as the monitor stores it before there is a reference.
  void BeginLearning(const std::string& axis) {
    ASSERT_TRUE(journal().Change("press/" + axis, 1.7e9, [](AxisContent& content) -> Status {
      content.monitor.state = {0, 1, 2};
      return {};
    }));
  }
  AlarmState StateOf(const std::string& axis, int alarm) {
    auto content = journal().Axis("press/" + axis);
    return content ? content->Alarm(fmt::format("alarm_{}", alarm)) : AlarmState{};
  }

 private:
  std::string folder_;
  std::optional<AlarmJournal> journal_;
};

}  // namespace hydroscope
