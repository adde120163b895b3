#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/commands.h"
#include "cli/machines/press_settings.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

std::string TempFile(const std::string& name) {
  return testing::TempDir() + "simulate_" + testing::UnitTest::GetInstance()->current_test_info()->name() +
         "_" + name;
}
std::string ReadAll(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}
int Simulate(std::vector<std::string> words) {
  std::vector<const char*> argv = {"hydroscope", "simulate"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  return RunCommandLine(static_cast<int>(argv.size()), argv.data());
}

TEST(ParseEffect, ReadsSizeAndFurtherNumbers) {
  const auto effect = ParseEffect("relief_valve=2e-11,crack=170e5");
  ASSERT_TRUE(effect);
  EXPECT_EQ(effect->id, "relief_valve");
  EXPECT_DOUBLE_EQ(effect->size, 2e-11);
  EXPECT_DOUBLE_EQ(effect->extra.at("crack"), 170e5);
}

TEST(ParseEffect, TakesTheTypicalSizeWhenNoneIsGiven) {
  EXPECT_DOUBLE_EQ(ParseEffect("internal_leakage")->size, 4e-12);
}

TEST(ParseEffect, SaysWhatIsNoNumber) {
  const auto effect = ParseEffect("relief_valve=much");
  ASSERT_FALSE(effect);
  EXPECT_EQ(effect.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(effect.error().text, HasSubstr("relief_valve=much"));
}

TEST(ParseFault, ReadsAllParts) {
  const auto fault = ParseFault("offset_drift:p_A:30:20:5e5");
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->kind, FaultKind::kOffsetDrift);
  EXPECT_EQ(fault->channel, "p_A");
  EXPECT_DOUBLE_EQ(fault->start, 30);
  EXPECT_DOUBLE_EQ(fault->duration, 20);
  EXPECT_DOUBLE_EQ(fault->size, 5e5);
}

TEST(ParseFault, SaysWhichKindsThereAreAndWhichNeedASize) {
  EXPECT_THAT(ParseFault("broken:p_A:1:2").error().text, HasSubstr("offset_drift"));
  EXPECT_THAT(ParseFault("spike:p_A:1:2").error().text, HasSubstr("needs a size"));
  EXPECT_THAT(ParseFault("nan:p_A").error().text, HasSubstr("kind:channel:start:duration"));
}

TEST(ParseOil, ReadsARampAndASingleTemperature) {
  PressOptions options;
  ASSERT_TRUE(ParseOil("26:52", options));
  EXPECT_DOUBLE_EQ(options.oil_start, 299.15);
  EXPECT_DOUBLE_EQ(options.oil_end, 325.15);
  ASSERT_TRUE(ParseOil("30", options));
  EXPECT_DOUBLE_EQ(options.oil_start, options.oil_end);
  EXPECT_FALSE(ParseOil("26:", options));
  EXPECT_FALSE(ParseOil("1:2:3", options));
}

TEST(SimulateCommand, WritesLogAndTruth) {
  const std::string out = TempFile("log.csv"), truth = TempFile("truth.json");
  ASSERT_EQ(Simulate({"press", "--out", out, "--seconds", "2", "--effect", "internal_leakage=4e-12",
                      "--truth", truth}),
            kDone);
  const std::string text = ReadAll(out);
  EXPECT_EQ(text.substr(0, text.find('\n')), "t,p_A,p_B,p_0,z,y_v,U_v,T_oil");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1001);
  const auto json = nlohmann::json::parse(ReadAll(truth));
  EXPECT_DOUBLE_EQ(json["parameters"]["K"], 1.21e9);
  EXPECT_EQ(json["effects"][0]["id"], "internal_leakage");
  EXPECT_EQ(json["strokes"].size(), 1u);
}

TEST(SimulateCommand, SameSeedGivesTheSameBytesPackedOrNot) {
  const std::string plain = TempFile("a.csv"), packed = TempFile("a.csv.gz");
  ASSERT_EQ(Simulate({"press", "--out", plain, "--seconds", "3", "--seed", "5"}), kDone);
  ASSERT_EQ(Simulate({"press", "--out", packed, "--seconds", "3", "--seed", "5"}), kDone);
  const gzFile file = gzopen(packed.c_str(), "rb");
  ASSERT_NE(file, nullptr);
  std::string text(1 << 20, ' ');
  text.resize(static_cast<std::size_t>(gzread(file, text.data(), static_cast<unsigned>(text.size()))));
  gzclose(file);
  EXPECT_EQ(text, ReadAll(plain));
  EXPECT_LT(std::filesystem::file_size(packed), std::filesystem::file_size(plain) / 2);
}

TEST(SimulateCommand, FourCylindersWriteFourFilesWithTheEffectInOne) {
  const std::string out = TempFile("c.csv"), truth = TempFile("c.json");
  ASSERT_EQ(Simulate({"press", "--out", out, "--seconds", "1", "--cylinders", "4", "--effect",
                      "external_leakage", "--effect-cylinder", "2", "--truth", truth}),
            kDone);
  for (int k = 1; k <= 4; ++k) {
    EXPECT_TRUE(std::filesystem::exists(TempFile("c_" + std::to_string(k) + ".csv")));
    const auto json = nlohmann::json::parse(ReadAll(TempFile("c_" + std::to_string(k) + ".json")));
    EXPECT_EQ(json["effects"].size(), k == 2 ? 1u : 0u);
  }
}

TEST(SimulateCommand, ImperfectionsAreTakenListedAndRefused) {
  const auto parsed = ParseImperfection("coloured_noise=0.1,phi=0.9,on=p_A");
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->kind, "coloured_noise");
  EXPECT_EQ(parsed->size, 0.1);
  EXPECT_EQ(parsed->extra.at("phi"), 0.9);
  EXPECT_EQ(parsed->channel, "p_A");
  EXPECT_EQ(ParseImperfection("K_drift")->size, -0.1);
  EXPECT_FALSE(ParseImperfection("K_drift=much"));
  EXPECT_NE(ImperfectionTable().find("pressure_signal_lag"), std::string::npos);
  const std::string out = TempFile("i.csv"), truth = TempFile("i.json");
  ASSERT_EQ(Simulate({"press", "--out", out, "--seconds", "1", "--imperfection", "K_drift=-0.05", "--truth",
                      truth}),
            kDone);
  EXPECT_EQ(nlohmann::json::parse(ReadAll(truth))["imperfections"][0]["kind"], "K_drift");
  EXPECT_EQ(Simulate({"press", "--out", out, "--imperfection", "K_drit=1"}), kWrongUse);
}

TEST(SimulateCommand, ValveSweepHasItsColumns) {
  const std::string out = TempFile("sweep.csv");
  ASSERT_EQ(Simulate({"valve", "--out", out, "--frequencies", "10,20", "--hold", "0.5"}), kDone);
  const std::string text = ReadAll(out);
  EXPECT_EQ(text.substr(0, 10), "t,U_v,y_v\n");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1001);
}

TEST(SimulateCommand, WrongUseAndUnwritableFilesHaveTheirExitCodes) {
  const std::string out = TempFile("x.csv");
  EXPECT_EQ(Simulate({"press"}), kWrongUse);
  EXPECT_EQ(Simulate({"press", "--out", out, "--effect", "internal_leakge=1e-12"}), kWrongUse);
  EXPECT_EQ(Simulate({"press", "--out", out, "--speed-min", "150"}), kWrongUse);
  EXPECT_EQ(Simulate({"press", "--out", out, "--fault", "nan:p_Q:1:1"}), kWrongUse);
  EXPECT_EQ(Simulate({"press", "--out", "/nonexistent/x.csv", "--seconds", "1"}), kWrongInput);
  EXPECT_EQ(Simulate({"press", "--out", out, "--machine", "/nonexistent/m.toml"}), kWrongInput);
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace hydroscope
