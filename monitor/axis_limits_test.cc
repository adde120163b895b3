// Limits of [monitor.*] and loss of signals, which need no reference: judged before the healthy machine is learned,
// while it is being learned, and after.
#include "monitor/press_monitor_fixture.h"

namespace hydroscope {
namespace {

using namespace press_monitor_test;
using testing::ElementsAre;
using testing::IsEmpty;

class AxisLimitsTest : public PressMonitorTest {
 protected:
  void SetUp() override {
    PressMonitorTest::SetUp();
    machine_.monitors = {{"K", 1.5e9, {}, {}, {}, {}}};  // bulk modulus is 1.2e9 Pa: always below
  }
  /// "EVENT STROKE" of the limit.
  std::vector<std::string> Told() const {
    std::vector<std::string> events;
    for (const JournalRow& row : Journal())
      if (row.event.alarm == "K.warn_low")
        events.push_back(fmt::format("{} {}", row.event.event, row.event.stroke));
    return events;
  }
  void StoreHealthy(std::size_t first, std::size_t last) {
    Store(0, {Healthy().begin() + static_cast<std::ptrdiff_t>(first),
              Healthy().begin() + static_cast<std::ptrdiff_t>(last)});
  }
};

TEST_F(AxisLimitsTest, AreJudgedWhileTheHealthyMachineIsLearnedAndOnceEach) {
  StoreHealthy(0, 40);
  {
    const auto press = Open();
    ASSERT_OK(press->CatchUp(1000));
    EXPECT_EQ(press->axis(0).monitor(), nullptr);
    EXPECT_EQ(press->axis(0).commissioning_strokes(), 40);
    EXPECT_THAT(Standing(press->axis(0)), ElementsAre("UNACK K.warn_low"));
    EXPECT_EQ(press->axis(0).Health(), 'C') << "and nothing else is judged";
  }
  const auto told = Told();
  EXPECT_EQ(told.size(), 1u);
  const auto press = Open();
  StoreHealthy(40, 105);
  ASSERT_OK(press->CatchUp(2000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  EXPECT_EQ(press->axis(0).monitor()->reference().first_sequence(), 0) << "all were learned from";
  EXPECT_THAT(Standing(press->axis(0)), ElementsAre("UNACK K.warn_low"));
  EXPECT_EQ(Told(), told) << "neither cleared by learning nor raised again";
}

TEST_F(AxisLimitsTest, SayTheSameHoweverManyStrokesThereAreAtATime) {
  {
    const auto press = Open();
    for (std::size_t k = 0; k < 105; ++k) {
      StoreHealthy(k, k + 1);
      ASSERT_OK(press->CatchUp(1000));
    }
  }
  const auto one_by_one = Told();
  TearDown();
  runs_.clear();
  ids_.clear();
  stored_.clear();
  SetUp();
  StoreHealthy(0, 105);
  ASSERT_OK(Open()->CatchUp(1000));
  EXPECT_THAT(one_by_one, testing::Not(IsEmpty()));
  EXPECT_EQ(Told(), one_by_one);
}

TEST_F(AxisLimitsTest, SignalsThatAreLostWhileTheHealthyMachineIsLearnedAreToldAndLearningDoesNotClearThem) {
  machine_.monitors.clear();
  std::vector<StrokeRecord> strokes(Healthy().begin(), Healthy().begin() + 100);
  for (std::size_t k = 90; k < 100; ++k)
    strokes[k].summary.counters.used = strokes[k].summary.counters.gated / 5;
  Store(0, {strokes.begin(), strokes.begin() + 95});
  {
    const auto press = Open();
    ASSERT_OK(press->CatchUp(1000));
    EXPECT_EQ(press->axis(0).monitor(), nullptr);
    EXPECT_THAT(Standing(press->axis(0)), ElementsAre("UNACK signal_loss"));
    EXPECT_EQ(press->axis(0).Health(), 'F');
  }
  Store(0, {strokes.begin() + 95, strokes.end()});
  const auto press = Open();
  ASSERT_OK(press->CatchUp(2000));
  ASSERT_NE(press->axis(0).monitor(), nullptr);
  EXPECT_THAT(Standing(press->axis(0)), testing::Contains("UNACK signal_loss"));
  EXPECT_THAT(Events(), testing::Contains("press/left signal_loss raised 92"));
  StoreHealthy(90, 95);
  ASSERT_OK(press->CatchUp(3000));
  EXPECT_THAT(Events(), testing::Contains("press/left signal_loss cleared 102"));
}

TEST_F(AxisLimitsTest, StrokesThatWereJudgedAreNotJudgedAgainByAReferenceOfEarlierOnes) {
  std::string rules = kRules;
  Write("press_rules.toml", rules.replace(rules.find("\"automatic\""), 11, "\"command\""));
  auto strokes = Healthy();
  strokes.insert(strokes.end(), Healthy().begin(), Healthy().begin() + 60);
  for (std::size_t k = 0; k < strokes.size(); ++k)
    for (Estimate& estimate : strokes[k].estimates)
      if (estimate.parameter == "K") estimate.value = k >= 105 && k < 115 ? 1e9 : 2e9;
  Store(0, strokes);
  const auto press = Open();
  ASSERT_OK(press->CatchUp(1000));
  const auto told = Told();
  EXPECT_EQ(told.size(), 2u) << "raised and cleared";
  ASSERT_OK(press->axis(0).Learn(0, 100, 1500, {"anna", "healthy"}));
  ASSERT_OK(Open()->CatchUp(2000));
  EXPECT_EQ(Told(), told);
}

}  // namespace
}  // namespace hydroscope
