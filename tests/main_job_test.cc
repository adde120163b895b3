// The main job, as processes: a press that works much faster than in life and the service that learns it.
#include "acquisition/live_sources.h"
#include "tests/program_process.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using ::testing::AllOf;
using ::testing::HasSubstr;

void Replace(std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

class MainJob : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    TestPress reserve;
    const std::string machines = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/";
    std::string text = ReadText(machines + "press_live.toml");
    Replace(text, "domain = 0", fmt::format("domain = {}", OwnDomain()));
    Replace(text, "port = 1502", fmt::format("port = {}", reserve.port()));
    Replace(text, R"(axes = ["cushion_1", "cushion_2", "cushion_3", "cushion_4"])",
            R"(axes = ["cushion_1"])");
    WriteText(File("press.toml"), text);
  }
};

TEST_F(MainJob, FilesBesideTheDatabaseThatAreDeletedMakeItBeginAgainWithAllThatWasStored) {
  Program press({"simulate", "press", "--serve", File("press.toml"), "--speed", "30"}, File("press.out"));
  ASSERT_TRUE(press.WaitFor("serving"));
  Program service({"serve", File("press.toml"), "--db", File("press.db"), "--port", "0", "--acknowledge"},
                  File("service.out"));
  ASSERT_TRUE(service.WaitFor("strokes 3")) << ReadText(File("service.out.err"));
  ASSERT_TRUE(
      WaitUntil([&] { return ReadText(File("service.out.err")).find("sender_found") != std::string::npos; }));
  std::filesystem::remove(File("press.db-wal"));
  std::filesystem::remove(File("press.db-shm"));
  const auto begun = [&] {
    const std::string log = ReadText(File("service.out.err"));
    const auto again = log.find("begins_again");
    return again != std::string::npos && log.find(" serving ", again) != std::string::npos;
  };
  ASSERT_TRUE(WaitUntil(begun)) << ReadText(File("service.out.err"));
  EXPECT_EQ(service.Kill(SIGTERM), 0);
  const auto trends = Run({"trends", "--db", File("press.db"), "--json", "-"});
  ASSERT_EQ(trends.exit_code, 0) << trends.err;
  EXPECT_GE(trends.Json().at("summary")[0].at("strokes"), 3);
}

TEST_F(MainJob, TheDemoShowsAWornSealExplainedAcknowledgedAndReplayedToTheSame) {
  const std::string demo = fmt::format("HYDROSCOPE={} {}/scripts/demo.sh {} > {} 2>&1", HYDROSCOPE_BINARY,
                                       HYDROSCOPE_SOURCE_DIR, File("demo"), File("demo.txt"));
  ASSERT_EQ(std::system(demo.c_str()), 0) << ReadText(File("demo.txt"));
  EXPECT_THAT(ReadText(File("demo.txt")),
              AllOf(HasSubstr("UNACK warning     press/cushion_2 / internal_leakage"),
                    HasSubstr("\nhttp://127.0.0.1:")));
  const auto told = [&](const char* what) {
    return Run({"alarms", "--db", File("demo/press.db"), what, "--json", "-"}).Json();
  };
  std::map<std::string, nlohmann::json> first;  // row of each event
  const nlohmann::json journal = told("journal"), list = told("list");
  for (const nlohmann::json& row : journal.at("journal")) first.emplace(row.at("event"), row);
  EXPECT_EQ(first.at("raised").at("alarm"), "internal_leakage");
  EXPECT_THAT(first.at("explained").at("text").get<std::string>(), HasSubstr("internal_leakage"));
  EXPECT_TRUE(first.contains("acknowledged"));
  const nlohmann::json& alarm = list.at("alarms").at(0);
  EXPECT_EQ(alarm.at("state"), "ACKED");
  EXPECT_NEAR(alarm.at("value").get<double>(), 2e-12, 0.2e-12);
}

}  // namespace
}  // namespace hydroscope
