#include "live/live_status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace hydroscope {
namespace {

using testing::HasSubstr;

TEST(LiveStatus, SaysWhyAnEstimateIsNotToBeTrusted) {
  LiveStatus status;
  status.kind = "die_cushion";
  status.axes.push_back({"press/left", {}, 1, 0, {}});
  status.axes[0].estimates = {{"K", 1.2e9, 2e6, "Pa", 1, 0, EstimateReason::kConfounded},
                              {"V0", 2e-3, 2e-5, "m3", 1, 0, EstimateReason::kUpdated}};
  AxisHealth health;
  health.name = "press/left";
  health.statements = {{.parameter = "K", .confounded = true, .why = {"a leak would move it", "ein Leck"}},
                       {.parameter = "V0", .shared = 0.005, .why = {}}};
  status.drift.axes = {health};
  const nlohmann::json json = StatusJson(status), &estimates = json["axes"][0]["estimates"];
  EXPECT_EQ(estimates["K"]["why"], "a leak would move it");
  EXPECT_FALSE(estimates["V0"].contains("why"));
  EXPECT_EQ(json["drift"]["axes"][0]["statements"][0]["german"]["why"], "ein Leck");
  EXPECT_EQ(json["drift"]["axes"][0]["statements"][1]["shared"], 0.005);
  EXPECT_THAT(StatusText(json), HasSubstr("K NOT IDENTIFIABLE: a leak would move it"));
}

TEST(LiveStatus, WarnsOfEstimatesThatNoMachineHas) {
  LiveStatus status;
  status.kind = "die_cushion";
  status.axes.push_back({.name = "press/left", .warnings = {{"no oil has that", "das hat kein Öl"}}});
  const nlohmann::json json = StatusJson(status), &axis = json["axes"][0];
  EXPECT_EQ(axis["warnings"], nlohmann::json({"no oil has that"}));
  EXPECT_EQ(axis["german"]["warnings"], nlohmann::json({"das hat kein Öl"}));
  EXPECT_THAT(StatusText(json), HasSubstr("\n  WARNING: no oil has that"));
}

}  // namespace
}  // namespace hydroscope
