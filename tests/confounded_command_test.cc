#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ConfoundedCommand : public CommandLine {
 protected:
  nlohmann::json Parameters(const std::string& command, const std::string& log) {
    const Ran ran = Run({command, log, "-m", kMachine, "--json", "-"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return ran.Json()["parameters"];
  }
};

TEST_F(ConfoundedCommand, AtOneRamSpeedTheNominalFlowRestsOnThereBeingNoLeak) {
  const std::string log =
      Simulate("one_speed.csv", 90, 5,
               {"--speed-min", "50", "--speed-max", "50", "--effect", "internal_leakage=4e-12"});
  for (const char* command : {"fit", "check"}) {
    const nlohmann::json q = Parameters(command, log)["Q_vn"];
    EXPECT_EQ(q["identifiable"], false) << command << q.dump(1);
    EXPECT_EQ(q["reason"], "confounded");
    ASSERT_TRUE(q.contains("confounded_with")) << q.dump(1);
    EXPECT_THAT(q["confounded_with"], Contains("internal_leakage"));
    EXPECT_GT(std::abs(q["confounded_bias"].get<double>()), 1e-5) << "m3/s, a percent of the nominal flow";
    EXPECT_THAT(q["advice"].get<std::string>(), HasSubstr("vary ram speed"));
    EXPECT_THAT(Run({command, log, "-m", kMachine}).out, HasSubstr("confounded with"));
  }
}

TEST_F(ConfoundedCommand, WithVariedSpeedsNothingIsConfounded) {
  for (int seed = 1; seed <= 5; ++seed) {
    const std::string log = Simulate("varied.csv", 90, seed);
    const nlohmann::json parameters = Parameters("fit", log);
    for (const auto& [name, parameter] : parameters.items())
      EXPECT_FALSE(parameter.contains("confounded_with")) << seed << name << parameter.dump(1);
    EXPECT_THAT(Run({"fit", log, "-m", kMachine}).out, Not(HasSubstr("confounded")));
  }
}

}  // namespace
}  // namespace hydroscope
