#include "live/surveillance.h"

#include <gmock/gmock.h>

#include "live/live_service_fixture.h"
#include "simulator/test_cylinder/test_cylinder.h"

namespace hydroscope {
namespace {

using namespace live_service_test;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SurveillanceTest : public LiveServiceTest {
 protected:
  /// Warnings of the left axis after 20 000 rows of this log.
  std::vector<std::string> WarningsAfter(const SimulatedLog& log) {
    PlayedSource::plays = &log;
    PlayedSource::done = false;
    const Clock clock = [this] { return clock_(); };
    auto service = ServiceOn(0, 20'000, 0);
    EXPECT_TRUE(service) << (service ? "" : service.error().text);
    if (!service) return {"no service"};
    ValveChecks checks(**service, {}, clock);
    Surveillance surveillance(**service, checks, options_, clock);
    EXPECT_OK((*service)->Start());
    while (!PlayedSource::done) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    WaitForWhatWasSent(**service);
    const LiveStatus status = surveillance.status();
    EXPECT_GT(status.axes[0].strokes, 1);
    checks.Stop();
    EXPECT_TRUE((*service)->Stop());
    PlayedSource::plays = nullptr;
    return InEnglish(status.axes[0].warnings);
  }
};

TEST_F(SurveillanceTest, StatusSaysNothingOfEstimatesThatAMachineMayHave) {
  EXPECT_THAT(WarningsAfter(Log()), IsEmpty());
}

TEST_F(SurveillanceTest, StatusTellsWhatMakesTheNewestEstimatesDoubtful) {
  SimulatedLog wrong_scale = Log();
  for (double& pressure : wrong_scale.p_A) pressure *= 0.1;
  EXPECT_THAT(WarningsAfter(wrong_scale), ElementsAre(HasSubstr("K comes out as")));
}

TEST_F(SurveillanceTest, StatusTellsOfASpoolThatMovesBeyondItsEnds) {
  SimulatedLog wrong_scale = Log();
  for (double& spool : wrong_scale.y_v) spool *= 5;
  EXPECT_THAT(WarningsAfter(wrong_scale), Contains(HasSubstr("% of where it ends")));
}

const char* const kCylinders = R"toml(
[machine]
name = "press"
model = "test_cylinder"
[live]
grid_period = 0.002
axes = ["left", "right"]
[live.dds]
domain = 0
[signals]
z_set = { dds = "{axis}/z_set", unit = "m", stuck_time = 0 }
I_v   = { dds = "{axis}/I_v", unit = "A", stuck_time = 0 }
z     = { dds = "{axis}/z", unit = "m" }
T_oil = { modbus = { register = 30 }, unit = "degC", stuck_time = 0, required = false }
[live.modbus]
poll_period = 0.5
[episodes]
seconds = 10
[geometry]
A = { value = 1300.6, unit = "mm2" }
)toml";

/// Set point, current and position of the simulated test cylinder in place of what a press sends; at half its speed.
SimulatedLog AsAPressSends(const TestCylinderLog& cylinder) {
  SimulatedLog log;
  log.t = cylinder.t;
  log.p_A = cylinder.z_set;
  log.z = cylinder.I_v;
  log.y_v = cylinder.z;
  return log;
}

TEST_F(SurveillanceTest, StatusTellsOfAnInputWhoseReadingsEnd) {
  std::ofstream(File("press.toml")) << kCylinders;
  SimulatedLog log = AsAPressSends(SimulateTestCylinder({.seconds = 20.1, .sample_period = 1e-3, .seed = 3}));
  EXPECT_THAT(WarningsAfter(log), IsEmpty());
  std::filesystem::remove(options_.database);
  clock_.Set(1'000'000'000);
  for (double& current : log.z) current = std::clamp(current, -0.012, 0.012);
  EXPECT_THAT(WarningsAfter(log), ElementsAre(HasSubstr("I_v never reads more than 0.012 A")));
}

}  // namespace
}  // namespace hydroscope
