#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/commands.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

/// Commands on logs of the simulated test cylinder; exit code, stdout in out_, stderr in err_.
class LoopCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("loop_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(std::ifstream(Path(name)));
  }
  int Run(std::vector<std::string> words) {
    words.insert(words.begin(), "hydroscope");
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = RunCommandLine(static_cast<int>(argv.size()), argv.data());
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return code;
  }
  void Simulate(const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words = {"simulate", "test-cylinder", "--out",
                                      Path(name), "--truth",       Path(name + ".json")};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(Run(words), 0) << err_;
  }

  const std::string machine_ = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/test_cylinder.toml";
  std::filesystem::path folder_;
  std::string out_, err_;
};

TEST_F(LoopCommand, FrfGivesTheTruthWithTheDocumentedKeysAndAPicture) {
  Simulate("c.csv", {"--seconds", "40"});
  ASSERT_EQ(Run({"frf", Path("c.csv"), "-m", machine_, "--json", Path("c_frf.json"), "--svg", Path("c.svg")}),
            0)
      << err_;
  const auto json = Json("c_frf.json"), truth = Json("c.csv.json");
  for (const char* name : {"f_h", "zeta_h", "f_sv", "K_sv"}) {
    const double value = json["model"][name]["value"], true_value = truth["parameters"][name];
    EXPECT_NEAR(value, true_value, 3 * json["model"][name]["std"].get<double>()) << name;
  }
  for (const char* key :
       {"points", "left_out", "direct_bias", "needed_seconds", "segments", "warnings", "input_limit"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_TRUE(json["points"][5].contains("direct_gain"));
  EXPECT_THAT(out_, HasSubstr("natural frequency of the oil column"));
  std::ifstream picture(Path("c.svg"));
  std::string head(4, ' ');
  picture.read(head.data(), 4);
  EXPECT_EQ(head, "<svg");
}

TEST_F(LoopCommand, TheExchangeOfTheValveIsItsGainThatDoubledAndNothingElse) {
  Simulate("old.csv", {"--seconds", "40"});
  Simulate("new.csv", {"--seconds", "40", "--valve", "38", "--seed", "2"});
  ASSERT_EQ(
      Run({"explain", Path("new.csv"), "-m", machine_, "--since", Path("old.csv"), "--json", Path("x.json")}),
      0)
      << err_;
  const auto json = Json("x.json");
  EXPECT_EQ(json["verdict"], "named");
  EXPECT_EQ(json["set"], nlohmann::json({"valve_gain"}));
  EXPECT_NEAR(json["changes"]["valve_gain"]["value"], 2.02, 0.1);
  EXPECT_THAT(out_, HasSubstr("Nothing else changed"));
}

TEST_F(LoopCommand, WithoutSinceTheReferencesOfTheMachineFileAreCompared) {
  Simulate("c.csv", {"--seconds", "40"});
  ASSERT_EQ(Run({"explain", Path("c.csv"), "-m", machine_, "--json", "-"}), 0) << err_;
  EXPECT_EQ(nlohmann::json::parse(out_)["verdict"], "adequate");
}

TEST_F(LoopCommand, BadInputAndWrongUseAreToldApart) {
  Simulate("c.csv", {"--seconds", "5"});
  EXPECT_EQ(Run({"frf", Path("c.csv"), "-m", machine_, "--method", "sine"}), 2);
  EXPECT_EQ(Run({"frf", Path("absent.csv"), "-m", machine_}), 3);
  EXPECT_EQ(Run({"explain", Path("c.csv"), "-m", machine_, "--since", Path("absent.csv")}), 3);
  EXPECT_EQ(Run({"explain", Path("c.csv"), Path("c.csv"), "-m", machine_}), 2);
  EXPECT_EQ(Run({"simulate", "test-cylinder", "--out", Path("x.csv"), "--f-h", "-3"}), 2);
  EXPECT_EQ(Run({"simulate", "test-cylinder", "--out", Path("x.csv"), "--valve", "63"}), 2);
  EXPECT_EQ(Run({"fit", Path("c.csv"), "-m", machine_}), 3);
  std::ofstream(Path("bad.csv")) << "t,z_set,I_v\n0,1,2\n";
  EXPECT_EQ(Run({"frf", Path("bad.csv"), "-m", machine_}), 3);
  EXPECT_THAT(err_, HasSubstr("z"));
}

TEST_F(LoopCommand, ALimitOfTheMachineFileThatIsPassedIsSaid) {
  Simulate("slow.csv", {"--seconds", "40", "--f-sv", "120"});
  Run({"frf", Path("slow.csv"), "-m", machine_});
  EXPECT_THAT(out_, HasSubstr("below alarm_low 130"));
}

}  // namespace
}  // namespace hydroscope
