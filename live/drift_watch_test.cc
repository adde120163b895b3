#include "live/drift_watch.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "monitor/press_monitor_fixture.h"

namespace hydroscope {
namespace {

using press_monitor_test::PressMonitorTest;
using testing::HasSubstr;

/// A service of two axes whose channels all come; of the second one no rows come of it.
class DriftWatchTest : public PressMonitorTest {
 protected:
  LiveStatus Live() {
    LiveStatus live;
    live.uptime = 100;
    live.axes.resize(2);
    const std::int64_t rows = ++looks_;
    live.axes[0].counters.rows = rows;
    live.axes[1].counters.rows = second_goes_on_ ? rows : 1;
    for (int axis = 0; axis < 2; ++axis) {
      live.channels.push_back(
          {.name = fmt::format("axis_{}/p_A", axis), .unit = "Pa", .axis = axis, .required = true});
      live.channels.back().usable = axis == 0 || second_is_usable_;
    }
    return live;
  }
  /// Every look is a second later than the one before.
  HostTime Clock() {
    return {.monotonic_ns = (seconds_ += 1) * 1'000'000'000, .wall_ns = 1'700'000'000'000'000'000};
  }
  bool WaitForRows(std::size_t count) {
    for (int k = 0; k < 500 && Journal().size() < count; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return Journal().size() >= count;
  }

  std::atomic<std::int64_t> looks_ = 0, seconds_ = 0;
  std::atomic<bool> second_goes_on_ = false, second_is_usable_ = true;
};

TEST_F(DriftWatchTest, SamplesThatAreOfNoUseAreNoSamples) {
  DriftWatch watch(Open(), {.status = [this] { return Live(); }, .checked_axis = [] { return -1; }},
                   [this] { return Clock(); });
  watch.Start();
  ASSERT_TRUE(WaitForRows(1));
  second_goes_on_ = true;
  ASSERT_TRUE(WaitForRows(2));
  second_is_usable_ = false;  // a cable breaks
  ASSERT_TRUE(WaitForRows(3));
  watch.Stop();
  const auto rows = Journal();
  for (const JournalRow& row : rows) {
    EXPECT_EQ(row.event.alarm, "no_samples");
    EXPECT_EQ(row.machine, AxisMachineName(machine_, 1));
  }
  EXPECT_EQ(rows[0].event.event, "raised");
  EXPECT_THAT(rows[0].event.text, HasSubstr("axis_1/p_A come, but not at the rate of [live] grid_period"));
  EXPECT_EQ(rows[1].event.event, "cleared");
  EXPECT_THAT(rows[2].event.text, HasSubstr("no usable samples of axis_1/p_A"));
}

TEST_F(DriftWatchTest, TellsTheBoardHowEstimatesOfEveryAxisAreStated) {
  const auto board = std::make_shared<HealthBoard>();
  DriftWatch watch(Open(), {[this] { return Live(); }, [] { return -1; }, board}, [this] { return Clock(); });
  watch.Start();
  const auto told = [&](int axis) {
    const auto statements = board->StatementsOf(AxisMachineName(machine_, axis));
    const EstimateStatement* volume = FindStatement(statements, "V0");
    return volume != nullptr && volume->shared > 0;
  };
  for (int k = 0; k < 500 && !(told(0) && told(1)); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  watch.Stop();
  EXPECT_TRUE(told(0));
  EXPECT_TRUE(told(1));
}

}  // namespace
}  // namespace hydroscope
