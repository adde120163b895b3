#include "page/work/valve_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "simulator/valve/valve_sweep.h"
#include "workbench/frequency_response/valve_output.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

class ValveResults : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// A sweep, as a log.
  std::string Sweep(const std::string& name, const ValveSweepOptions& options) const {
    const std::string path = folder_ + "/" + name;
    std::ofstream(path) << FormatValveSweep(SimulateValveSweep(options));
    return path;
  }
  nlohmann::json Measured(const std::vector<std::string>& logs, const std::string& before = "",
                          const FrequencyResponseOptions& options = {}) const {
    const auto json = WorkOutValve({logs, before, machine_}, options);
    EXPECT_TRUE(json) << (json ? "" : json.error().text);
    return json.value_or(nlohmann::json());
  }

  std::string folder_;
  const std::string machine_ = HYDROSCOPE_SOURCE_DIR "/machines/valve_sweep.toml";
};

TEST_F(ValveResults, AreThoseOfFrfWithTheModelBesideEachPoint) {
  const std::string sweep = Sweep("sweep.csv", {});
  const nlohmann::json json = Measured({sweep});
  const auto machine = LoadMachine(machine_);
  const auto log = MeasureValveLog(sweep, *machine);
  ASSERT_TRUE(machine && log);
  nlohmann::json frf = ValveJson(*log, *machine);
  for (std::size_t k = 0; k < json.at("points").size(); ++k) {
    nlohmann::json point = json["points"][k];
    EXPECT_NEAR(point["model_gain"].get<double>(), point["gain"].get<double>(), 1e-3);
    EXPECT_NEAR(point["model_phase_deg"].get<double>(), point["phase_deg"].get<double>(), 0.1);
    point.erase("model_gain");
    point.erase("model_phase_deg");
    EXPECT_EQ(point, frf["points"][k]);
  }
  EXPECT_EQ(json["points"].size(), frf["points"].size());
  for (const auto& [key, value] : frf.items()) {
    if (key == "points" || key == "left_out") continue;
    EXPECT_EQ(json.at(key).dump(), value.dump()) << key;
  }
  EXPECT_THAT(json["text"], HasSubstr("Frequency response U_v -> y_v, sweep.csv"));
  EXPECT_TRUE(json["before"].is_null());
}

TEST_F(ValveResults, StandBesideThoseOfAnEarlierRecord) {
  ValveSweepOptions worn;
  worn.f0 = 120;
  const std::string before = Sweep("before.csv", {}), now = Sweep("now.csv", worn);
  const nlohmann::json json = Measured({before, now}, before);
  EXPECT_EQ(json["log"], "now.csv");
  EXPECT_NEAR(json["model"]["f0_hz"]["value"].get<double>(), 120, 1);
  EXPECT_NEAR(json["before"]["model"]["f0_hz"]["value"].get<double>(), 183.9, 1);
  EXPECT_EQ(json["before"]["curve"]["f_hz"], json["curve"]["f_hz"]);
}

TEST_F(ValveResults, AnEarlierRecordThatTellsNothingIsToldAndNotCompared) {
  const std::string now = Sweep("now.csv", {}), before = folder_ + "/before.csv";
  std::ofstream(before) << "t,U_v,y_v\n0,0,0\n0.001,0,0\n0.002,0,0\n";
  const nlohmann::json json = Measured({before, now}, before);
  EXPECT_TRUE(json["before"].is_null());
  EXPECT_THAT(json["warnings"].back(), HasSubstr("before.csv"));
  EXPECT_THAT(json["german"]["warnings"].back(), HasSubstr("zu kurz"));
}

TEST_F(ValveResults, SayInGermanWhyThereIsNoModel) {
  ValveSweepOptions two;
  two.frequencies = {10, 20};
  const nlohmann::json json = Measured({Sweep("two.csv", two)});
  EXPECT_TRUE(json["model"].is_null());
  EXPECT_TRUE(json["curve"].is_null());
  EXPECT_THAT(json["model_reason"], HasSubstr("at least 3 usable frequencies"));
  EXPECT_THAT(json["german"]["model_reason"], HasSubstr("mindestens 3 brauchbare Frequenzen"));
}

TEST_F(ValveResults, GoByTheOptionsOfFrf) {
  FrequencyResponseOptions options;
  options.lowest = 45;
  options.highest = 105;
  const nlohmann::json json = Measured({Sweep("sweep.csv", {})}, "", options);
  EXPECT_EQ(json["points"].size(), 6u);
  EXPECT_EQ(json["left_out"], (nlohmann::json{{"outside_range", 10}}));
  EXPECT_EQ(json["options"]["to"], 105);
}

}  // namespace
}  // namespace hydroscope
