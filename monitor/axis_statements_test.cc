// How the live service states estimates is how `trends` and the report do.
#include <cmath>

#include "monitor/press_monitor_fixture.h"
#include "workbench/history/stated_estimates.h"

namespace hydroscope {
namespace {

using namespace press_monitor_test;

TEST_F(PressMonitorTest, AnAxisStatesItsEstimatesAsTheDatabaseDoes) {
  Store(0, {Healthy().begin(), Healthy().begin() + 40});
  const auto press = Open();
  const auto statements = press->axis(0).Statements();
  ASSERT_TRUE(statements) << statements.error().text;
  std::vector<Estimate> stored;
  const auto trend = database_->Trend(ids_[0], "", 39, 40);
  ASSERT_TRUE(trend);
  for (const TrendPoint& point : *trend) stored.push_back(point.estimate);
  std::vector<Estimate> stated = stored;
  const auto runs = database_->Runs(ids_[0]);
  ASSERT_TRUE(runs);
  const auto model = BuildModel(machine_);
  ASSERT_TRUE(StateEstimates(*database_, ids_[0], machine_, **model, *runs, stated));
  ASSERT_EQ(stored.size(), 4u);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    Estimate live = stored[i];
    StateEstimate(*statements, live);
    EXPECT_EQ(live.std, stated[i].std) << live.parameter;
    EXPECT_EQ(live.reason, stated[i].reason) << live.parameter;
  }
  const EstimateStatement* volume = FindStatement(*statements, "V0");
  ASSERT_NE(volume, nullptr);
  EXPECT_NEAR(volume->shared, 0.005, 1e-9) << "the area has no tolerance in the machine file";
  EXPECT_EQ(FindStatement(*statements, "K")->shared, 0);
}

TEST_F(PressMonitorTest, AnAxisWithoutStrokesStatesTolerancesAlone) {
  const auto statements = Open()->axis(1).Statements();
  ASSERT_TRUE(statements) << statements.error().text;
  EXPECT_GT(FindStatement(*statements, "Q_vn")->shared, 0);
  EXPECT_FALSE(FindStatement(*statements, "Q_vn")->confounded);
}

}  // namespace
}  // namespace hydroscope
