#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

std::string ArmFile(const std::string& name) {
  return testing::TempDir() + "arm_" + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
         name;
}
std::string ArmText(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}
const std::string kArmMachine = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/manipulator.toml";

/// Runs the command line; what it says to stderr is left in `error`.
int RunArm(std::vector<std::string> words, std::string* error = nullptr) {
  std::vector<const char*> argv = {"hydroscope"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  testing::internal::CaptureStderr();
  const int code = RunCommandLine(static_cast<int>(argv.size()), argv.data());
  const std::string text = testing::internal::GetCapturedStderr();
  if (error != nullptr) *error = text;
  return code;
}

TEST(SimulateManipulator, WritesALogAndItsTruth) {
  ASSERT_EQ(RunArm({"simulate", "manipulator", "--out", ArmFile("log.csv"), "--seconds", "5", "--effect",
                    "payload=50", "--truth", ArmFile("truth.json")}),
            0);
  EXPECT_THAT(ArmText(ArmFile("log.csv")),
              testing::StartsWith("t,q_1,q_2,p_11,p_12,p_21,p_22,y_1,y_2,p_s\n"));
  const auto truth = nlohmann::json::parse(ArmText(ArmFile("truth.json")));
  EXPECT_NEAR(truth["parameters"]["mx_2"].get<double>(), 1074.2 + 50 * 2.5, 0.1);
  EXPECT_EQ(truth["effects"][0], "payload=50");
}

TEST(SimulateManipulator, SaysWhatIsWrong) {
  std::string error;
  EXPECT_EQ(RunArm({"simulate", "manipulator"}, &error), 2);
  EXPECT_THAT(error, HasSubstr("--out"));
  EXPECT_EQ(RunArm({"simulate", "manipulator", "--out", "-", "--effect", "rust"}, &error), 2);
  EXPECT_THAT(error, HasSubstr("worn_edge_PA_1"));
  EXPECT_EQ(RunArm({"simulate", "manipulator", "--out", "-", "--sample-period", "0.003"}, &error), 2);
  EXPECT_THAT(error, HasSubstr("multiple"));
}

TEST(Design, FindsATrajectoryWithinItsLimits) {
  ASSERT_EQ(RunArm({"design", "-m", kArmMachine, "--range", "q_1=-0.15:0.85", "--range", "q_2=-2.2:-1",
                    "--out", ArmFile("plan.csv"), "--json", ArmFile("plan.json")}),
            0);
  const auto plan = nlohmann::json::parse(ArmText(ArmFile("plan.json")));
  EXPECT_LT(plan["condition"].get<double>(), 0.8 * plan["first_condition"].get<double>());
  EXPECT_EQ(plan["tells_apart"].size(), 10u);
  std::istringstream rows(ArmText(ArmFile("plan.csv")));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "t,q_1,q_2");
  double before = 0;
  for (int k = 0; std::getline(rows, row); ++k) {
    double t = 0, q_1 = 0, q_2 = 0;
    ASSERT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf", &t, &q_1, &q_2), 3);
    EXPECT_TRUE(q_1 > -0.151 && q_1 < 0.851 && q_2 > -2.201 && q_2 < -0.999) << row;
    if (k > 0) {
      EXPECT_LT(std::abs(q_1 - before) / 0.01, 0.51) << row;
    }
    before = q_1;
  }
}

TEST(Design, SaysWhatIsWrong) {
  std::string error;
  EXPECT_EQ(RunArm({"design", "-m", kArmMachine, "--range", "q_1"}, &error), 2);
  EXPECT_THAT(error, HasSubstr("SIGNAL=LOW:HIGH"));
  EXPECT_EQ(RunArm({"design", "-m", kArmMachine, "--range", "q_9=0:1"}, &error), 2);
  EXPECT_THAT(error, HasSubstr("q_9"));
  EXPECT_EQ(RunArm({"design", "-m", kArmMachine, "--range", "q_1=1:0"}, &error), 2);
  EXPECT_THAT(error, HasSubstr("no room"));
  EXPECT_EQ(RunArm({"design", "-m", kArmMachine, "--range", "q_1=0:1"}, &error), 2);
  EXPECT_THAT(error, HasSubstr("no equation"));
  EXPECT_EQ(RunArm({"design", "-m", std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/die_cushion.toml",
                    "--range", "z=0:1"},
                   &error),
            2);
  EXPECT_THAT(error, HasSubstr("linear"));
}

}  // namespace
}  // namespace hydroscope
