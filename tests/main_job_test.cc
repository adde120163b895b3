// The main job, as processes: a press that works much faster than in life, the service that learns it, a seal
// that begins to leak, the alarm with its explanation, an acknowledgement from outside, a clean stop.
#include "acquisition/live_sources.h"
#include "tests/program_process.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
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
    std::string rules = ReadText(machines + "die_cushion_rules.toml");
    Replace(rules, "commissioning = 1500", "commissioning = 100");
    WriteText(File("press_rules.toml"), rules);
  }

  nlohmann::json Journal() {
    const auto ran = Run({"alarms", "--db", File("press.db"), "journal", "--json", "-"});
    return ran.exit_code == 0 ? ran.Json().at("journal") : nlohmann::json::array();
  }
  /// The first row of this event; null before there is one.
  nlohmann::json Row(const std::string& event) {
    for (const nlohmann::json& row : Journal())
      if (row.at("event") == event) return row;
    return {};
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

TEST_F(MainJob, AWornSealRaisesAnExplainedAlarmWhileThePressWorks) {
  Program press({"simulate", "press", "--serve", File("press.toml"), "--speed", "30", "--oil", "38:42"},
                File("press.out"));
  ASSERT_TRUE(press.WaitFor("serving"));
  Program service({"serve", File("press.toml"), "--db", File("press.db"), "--port", "0"},
                  File("service.out"));
  const auto wait = [&](const std::string& event) {
    return WaitUntil([&] { return !Row(event).is_null(); }, 200);
  };
  ASSERT_TRUE(wait("reference_learned")) << ReadText(File("service.out.err"));
  EXPECT_TRUE(Row("raised").is_null());
  press.Say("effect internal_leakage=3e-12 axis=1");
  ASSERT_TRUE(wait("raised"));
  EXPECT_EQ(Row("raised").at("alarm"), "internal_leakage");
  EXPECT_NEAR(Row("raised").at("value").get<double>(), 3e-12, 1e-12);
  ASSERT_TRUE(wait("explained"));
  EXPECT_THAT(Row("explained").at("text").get<std::string>(), HasSubstr("internal_leakage"));
  const auto status = Run({"status", "--db", File("press.db")});
  EXPECT_THAT(status.out, HasSubstr("UNACK internal_leakage"));
  EXPECT_EQ(Run({"alarms", "--db", File("press.db"), "ack", "1", "--user", "anna"}).exit_code, 0);
  EXPECT_EQ(Row("acknowledged").at("user"), "anna");
  press.Say("quit");
  EXPECT_EQ(press.Wait(), 0);
  EXPECT_EQ(service.Kill(SIGTERM), 0);
  EXPECT_EQ(Run({"verify-live", "--db", File("press.db")}).exit_code, 0);
  const auto list = Run({"alarms", "--db", File("press.db"), "list", "--json", "-"});
  EXPECT_EQ(list.Json().at("alarms").at(0).at("state"), "ACKED")
      << Run({"alarms", "--db", File("press.db"), "journal"}).out;
}

}  // namespace
}  // namespace hydroscope
