#include "page/watch/watched_machine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "monitor/press_monitor_fixture.h"
#include "pipeline/run_summary.h"
#include "storage/storage_fixture.h"

namespace hydroscope {
namespace {

using namespace storage_test;

TEST(WatchedMachine, MayBeLookedAtFromBeforeItsFirstStrokeOn) {
  const Folder folder;
  Press press(folder.File());
  const auto watched =
      WatchedMachine::Create({press.database, folder.File(), nullptr, ""}, "press 7", press.machine);
  ASSERT_TRUE(watched) << watched.error().text;
  EXPECT_OK((*watched)->Refresh({}));
  EXPECT_EQ((*watched)->end(), 0);
  const RunInfo run = press.Begin("monday.csv");
  EXPECT_OK(press.database.StoreStrokes(run.id, MakeStrokes(0, 3)));
  EXPECT_OK((*watched)->Refresh({}));
  EXPECT_EQ((*watched)->end(), 3);
  EXPECT_TRUE((*watched)->json()["parameters"].empty()) << "another object knows the model";
}

using WatchedAxisTest = press_monitor_test::PressMonitorTest;

double StdOf(const WatchedMachine& watched, const std::string& parameter) {
  for (const nlohmann::json& p : watched.json()["parameters"])
    if (p["parameter"] == parameter) return p["std"].get<double>();
  ADD_FAILURE() << "no " << parameter;
  return 0;
}

TEST_F(WatchedAxisTest, StatesEstimatesAsTrendsDoesAndARunningServiceAsThat) {
  const auto& healthy = press_monitor_test::Healthy();
  Store(0, {healthy.begin(), healthy.begin() + 30});
  const std::string name = AxisMachineName(machine_, 0);
  const auto watched = WatchedMachine::Create({*database_, DatabasePath(), nullptr, ""}, name, ids_[0]);
  ASSERT_TRUE(watched) << watched.error().text;
  ASSERT_OK((*watched)->Refresh({}));
  const auto trend = database_->Trend(ids_[0], "V0", 29, 30);
  ASSERT_TRUE(trend);
  const Estimate& stored = trend->front().estimate;
  EXPECT_NEAR(StdOf(**watched, "V0") / std::hypot(stored.std, 0.005 * stored.value), 1, 1e-9);
  EXPECT_EQ((*watched)->picture().estimates[1].estimate.std, StdOf(**watched, "V0")) << "of tags";

  EXPECT_TRUE((*watched)->json()["warnings"].empty());

  const nlohmann::json told = {
      {"name", name},
      {"health", "C"},
      {"statements", {{{"parameter", "V0"}, {"shared", 0.1}, {"confounded", true}, {"why", "a leak"}}}}};
  ASSERT_OK((*watched)->Refresh(told));
  EXPECT_NEAR(StdOf(**watched, "V0") / std::hypot(stored.std, 0.1 * stored.value), 1, 1e-9);
  for (const nlohmann::json& p : (*watched)->json()["parameters"])
    if (p["parameter"] == "V0" && stored.reason == EstimateReason::kUpdated) {
      EXPECT_EQ(p["reason"], "confounded");
      EXPECT_EQ(p["reason_text"], "a leak");
    }
}

TEST_F(WatchedAxisTest, WarnsAsTheReplayOfItsNewestLogAndTheServiceDo) {
  const auto& healthy = press_monitor_test::Healthy();
  Store(0, {healthy.begin(), healthy.begin() + 30});
  RunSummary summary;
  summary.warnings = {"U_v never reads more than 5 V"};
  ASSERT_OK(database_->FinishRun(runs_[0], FormatRunSummary(summary), {}));
  const std::string name = AxisMachineName(machine_, 0);
  const auto watched = WatchedMachine::Create({*database_, DatabasePath(), nullptr, ""}, name, ids_[0]);
  ASSERT_TRUE(watched) << watched.error().text;
  const nlohmann::json told = {
      {"name", name},
      {"warnings", {"U_v never reads more than 5 V", "the valve has a dead band"}},
      {"german", {{"warnings", {"U_v zeigt nie mehr als 5 V", "das Ventil hat ein Totband"}}}}};
  ASSERT_OK((*watched)->Refresh(told));
  EXPECT_EQ((*watched)->json()["warnings"],
            nlohmann::json({"U_v never reads more than 5 V", "the valve has a dead band"}));
  EXPECT_EQ((*watched)->json()["german"]["warnings"][1], "das Ventil hat ein Totband");
}

}  // namespace
}  // namespace hydroscope
