#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "simulator/valve/valve_sweep.h"

namespace hydroscope {
namespace {

class FrfCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  void Write(const std::string& name, const std::string& text) const { std::ofstream(Path(name)) << text; }
  std::string Read(const std::string& name) const {
    std::ifstream file(Path(name));
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }
  /// `hydroscope frf log --machine machines/valve_sweep.toml <more>`; exit code, stdout in out_, stderr in err_.
  int Run(const std::string& log, std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"hydroscope", "frf", Path(log), "--machine",
                                      std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/valve_sweep.toml"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = RunCommandLine(static_cast<int>(argv.size()), argv.data());
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return code;
  }

  std::filesystem::path folder_;
  std::string out_, err_;
};

TEST_F(FrfCommand, PublishedValveComesOutWithTheDocumentedKeys) {
  Write("sweep.csv", FormatValveSweep(SimulateValveSweep({})));
  ASSERT_EQ(Run("sweep.csv", {"--json", Path("valve.json"), "--svg", Path("bode.svg")}), kDone) << err_;
  const auto json = nlohmann::json::parse(Read("valve.json"));
  EXPECT_NEAR(json["model"]["f0_hz"]["value"], 183.9, 0.5);
  EXPECT_NEAR(json["model"]["D"]["value"], 0.6735, 0.001);
  EXPECT_NEAR(json["model"]["K_v"]["value"], 1.005, 0.001);
  EXPECT_NEAR(json["model"]["T_dead_s"]["value"], 0, 1e-5);
  EXPECT_NEAR(json["bandwidth_3db_hz"], 192.6, 0.5);
  EXPECT_NEAR(json["phase_90_hz"], 183.9, 0.5);
  ASSERT_EQ(json["points"].size(), 16u);
  for (const char* key : {"f_hz", "gain", "phase_deg", "gain_std", "phase_std_deg"}) {
    EXPECT_TRUE(json["points"][3][key].is_number()) << key;
  }
  EXPECT_NE(out_.find("natural frequency f0   183.9"), std::string::npos) << out_;
  const std::string svg = Read("bode.svg");
  EXPECT_EQ(svg.rfind("<svg", 0), 0u);
  EXPECT_NE(svg.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

TEST_F(FrfCommand, JsonOnStdoutStandsAlone) {
  Write("sweep.csv", FormatValveSweep(SimulateValveSweep({})));
  ASSERT_EQ(Run("sweep.csv", {"--json", "-"}), kDone) << err_;
  EXPECT_TRUE(nlohmann::json::accept(out_)) << out_.substr(0, 200);
}

TEST_F(FrfCommand, LargeAmplitudeWithDistortionGivesAHint) {
  ValveSweepOptions options;
  options.sample_rate = 5000;
  ValveSweepLog log = SimulateValveSweep(options);
  for (double& y : log.y_v) y -= 60 * y * y * y;
  Write("sweep.csv", FormatValveSweep(log));
  Run("sweep.csv");
  EXPECT_NE(out_.find("half of 0.5 V"), std::string::npos) << out_;
}

TEST_F(FrfCommand, ALogOfNoiseIsBadInputAndSaysWhatToDo) {
  ValveSweepLog log = SimulateValveSweep({});
  unsigned state = 1;
  for (std::size_t n = 0; n < log.t.size(); ++n) {
    log.U_v[n] = static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) / (1 << 24) - 0.5;
    log.y_v[n] = static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) / (1 << 24) - 0.5;
  }
  Write("noise.csv", FormatValveSweep(log));
  EXPECT_EQ(Run("noise.csv"), kWrongInput);
  EXPECT_NE(err_.find("not related"), std::string::npos) << err_;
  EXPECT_NE(err_.find("check"), std::string::npos) << err_;
}

TEST_F(FrfCommand, LeftOutRowsAreListedAndTheExitCodeSaysPartly) {
  std::string text = FormatValveSweep(SimulateValveSweep({}));
  std::size_t line = 0;
  for (int i = 0; i < 2500; ++i) line = text.find('\n', line) + 1;
  text.replace(line, text.find('\n', line) - line, "2.499,,0.01");
  Write("hole.csv", text);
  EXPECT_EQ(Run("hole.csv"), kPartlyDone) << err_;
  EXPECT_NE(out_.find("rows left out (missing 1)"), std::string::npos) << out_;
}

TEST_F(FrfCommand, WrongUseIsToldFromBadInput) {
  Write("sweep.csv", FormatValveSweep(SimulateValveSweep({})));
  EXPECT_EQ(Run("sweep.csv", {"--method", "guess"}), kWrongUse);
  EXPECT_EQ(Run("sweep.csv", {"--segment", "31"}), kWrongUse);
  EXPECT_EQ(Run("absent.csv"), kWrongInput);
}

}  // namespace
}  // namespace hydroscope
