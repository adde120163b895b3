#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using testing::HasSubstr;

const std::string kArmMachine = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/manipulator.toml";

class SimulateManipulator : public CommandLine {
 protected:
  void Refused(const std::vector<std::string>& words, const std::string& why) {
    const Ran ran = Run(words);
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, HasSubstr(why));
  }
};
class Design : public SimulateManipulator {};

TEST_F(SimulateManipulator, WritesALogAndItsTruth) {
  ASSERT_EQ(Run({"simulate", "manipulator", "--out", File("log.csv"), "--seconds", "5", "--effect",
                 "payload=50", "--truth", File("truth.json")})
                .exit_code,
            0);
  EXPECT_THAT(ReadText(File("log.csv")), testing::StartsWith("t,q_1,q_2,p_11,p_12,p_21,p_22,y_1,y_2,p_s\n"));
  const auto truth = nlohmann::json::parse(ReadText(File("truth.json")));
  EXPECT_NEAR(truth["parameters"]["mx_2"].get<double>(), 1074.2 + 50 * 2.5, 0.1);
  EXPECT_EQ(truth["effects"][0], "payload=50");
}

TEST_F(SimulateManipulator, SaysWhatIsWrong) {
  Refused({"simulate", "manipulator"}, "--out");
  Refused({"simulate", "manipulator", "--out", "-", "--effect", "rust"}, "worn_edge_PA_1");
  Refused({"simulate", "manipulator", "--out", "-", "--sample-period", "0.003"}, "multiple");
}

TEST_F(Design, FindsATrajectoryWithinItsLimits) {
  ASSERT_EQ(Run({"design", "-m", kArmMachine, "--range", "q_1=-0.15:0.85", "--range", "q_2=-2.2:-1", "--out",
                 File("plan.csv"), "--json", File("plan.json")})
                .exit_code,
            0);
  const auto plan = nlohmann::json::parse(ReadText(File("plan.json")));
  EXPECT_LT(plan["condition"].get<double>(), 0.8 * plan["first_condition"].get<double>());
  EXPECT_EQ(plan["tells_apart"].size(), 10u);
  std::istringstream rows(ReadText(File("plan.csv")));
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

TEST_F(Design, SaysWhatIsWrong) {
  Refused({"design", "-m", kArmMachine, "--range", "q_1"}, "SIGNAL=LOW:HIGH");
  Refused({"design", "-m", kArmMachine, "--range", "q_9=0:1"}, "q_9");
  Refused({"design", "-m", kArmMachine, "--range", "q_1=1:0"}, "no room");
  Refused({"design", "-m", kArmMachine, "--range", "q_1=0:1"}, "no equation");
  Refused(
      {"design", "-m", std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/die_cushion.toml", "--range", "z=0:1"},
      "no trajectory is designed");
}

}  // namespace
}  // namespace hydroscope::command_line_test
