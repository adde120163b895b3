#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;

class Workbench : public CommandLine {
 protected:
  std::string LeakingLog() { return Simulate("leak.csv", 60, 4, {"--effect", "internal_leakage=4e-12"}); }
  std::string HealthyLog() { return Simulate("healthy.csv", 60, 5); }
};

std::vector<std::string> Keys(const nlohmann::json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

void ExpectKeys(const nlohmann::json& object, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_THAT(Keys(object), Contains(key));
}

/// Text as it stands in a Markdown table, where | ends a cell.
std::string InTable(const nlohmann::json& text) {
  std::string out;
  for (char c : text.get<std::string>()) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

TEST_F(Workbench, AHiddenLeakIsExplained) {
  const Ran ran = Run({"explain", LeakingLog(), "-m", kMachine, "--json", "-"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  const nlohmann::json json = ran.Json();
  EXPECT_THAT(json["verdict"], AnyOf("named", "ambiguous"));
  EXPECT_THAT(json["set"], Contains("internal_leakage"));
  EXPECT_GT(json["base"]["rms_holdout"].get<double>(), 1.1 * json["noise_floor"].get<double>());
  EXPECT_LT(json["steps"].back()["rms_holdout"].get<double>(), 1.1 * json["noise_floor"].get<double>());
  EXPECT_FALSE(json["located"].empty());
}

TEST_F(Workbench, AHealthyMachineIsAdequate) {
  const std::string log = HealthyLog();
  const Ran ran = Run({"explain", log, "-m", kMachine, "--json", "-"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(ran.Json()["verdict"], "adequate");
  EXPECT_TRUE(ran.Json()["set"].empty());
  const Ran compare = Run({"compare", log, "-m", kMachine});
  ASSERT_EQ(compare.exit_code, 0) << compare.err;
  EXPECT_THAT(compare.out, HasSubstr("down to the sensor noise"));
}

TEST_F(Workbench, TheJsonOfExplainHasTheKeysScriptsRelyOn) {
  const Ran ran = Run({"explain", LeakingLog(), "-m", kMachine, "--json", "-"});
  const nlohmann::json json = ran.Json();
  ASSERT_TRUE(json.is_object()) << ran.err;
  ExpectKeys(json, {"verdict", "set", "noise_floor", "strokes", "unit", "base", "ranking", "steps", "located",
                    "experiment"});
  EXPECT_EQ(json["unit"], "l/min");
  ExpectKeys(json["base"], {"rms_holdout", "parameters"});
  ExpectKeys(json["base"]["parameters"], {"K", "V0", "Q_vn", "y_0"});
  ExpectKeys(json["base"]["parameters"]["K"], {"value", "std", "unit"});
  EXPECT_TRUE(json["steps"][0]["added"].is_null());
  EXPECT_EQ(json["steps"][1]["added"], "internal_leakage");
  ExpectKeys(json["located"][0], {"signal", "from", "to", "unit", "rms"});
  for (const nlohmann::json& ranked : json["ranking"])
    ExpectKeys(ranked, {"effect", "rms_holdout", "p_value", "testable", "parameters"});
  ExpectKeys(json["ranking"][0]["parameters"]["G"], {"value", "std", "unit"});
}

TEST_F(Workbench, AddingTheEffectLowersTheErrorAndTakingItBackRestoresTheFile) {
  const std::string log = LeakingLog(), machine = File("press.toml");
  WriteText(machine, ReadText(kMachine));
  const Ran before = Run({"compare", log, "-m", machine, "--json", "-"});
  ASSERT_EQ(before.exit_code, 0) << before.err;
  EXPECT_TRUE(before.Json()["model_error_seen"]);

  const Ran add = Run({"model", "add", "internal_leakage", "-m", machine});
  ASSERT_EQ(add.exit_code, 0) << add.err;
  EXPECT_EQ(ReadText(File("press.v1.toml")), ReadText(kMachine));
  EXPECT_THAT(ReadText(machine),
              AllOf(HasSubstr("effects = [\"internal_leakage\"]"), HasSubstr("model_version = 2"),
                    HasSubstr("# Die cushion of a deep-drawing press")));
  const Ran after = Run({"compare", log, "-m", machine, "--json", "-"});
  ASSERT_EQ(after.exit_code, 0) << after.err;
  EXPECT_THAT(after.Json()["effects"], Contains("internal_leakage"));
  EXPECT_LT(after.Json()["rms_holdout"].get<double>(), 0.95 * before.Json()["rms_holdout"].get<double>());
  EXPECT_FALSE(after.Json()["model_error_seen"]);

  EXPECT_EQ(Run({"model", "add", "internal_leakage", "-m", machine}).exit_code, 3);
  EXPECT_EQ(Run({"model", "remove", "internal_leakage", "-m", machine}).exit_code, 0);
  EXPECT_EQ(ReadText(machine), ReadText(kMachine));
}

TEST_F(Workbench, AMistypedEffectSuggestsTheNearest) {
  const Ran ran = Run({"model", "add", "internal_leackage", "-m", kMachine, "--out", File("next.toml")});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, HasSubstr("did you mean 'internal_leakage'"));
  EXPECT_FALSE(std::filesystem::exists(File("next.toml")));
}

TEST_F(Workbench, EveryEffectIsInTheDocumentation) {
  const std::string text = ReadText(std::string(HYDROSCOPE_SOURCE_DIR) + "/docs/effects.md");
  const Ran ran = Run({"model", "effects", "--json", "-"});
  ASSERT_EQ(ran.exit_code, 0);
  const nlohmann::json effects = ran.Json()["effects"];
  EXPECT_GE(effects.size(), 18u);
  for (const nlohmann::json& effect : effects) {
    const auto at = text.find("\n| `" + effect["id"].get<std::string>() + "` |");
    ASSERT_NE(at, std::string::npos) << effect["id"];
    const std::string row = text.substr(at, text.find('\n', at + 1) - at);
    EXPECT_THAT(row, AllOf(HasSubstr(InTable(effect["title"])), HasSubstr(InTable(effect["law"])),
                           HasSubstr(InTable(effect["parameter"]))));
  }
}

TEST_F(Workbench, BadInputIsThreeAndNamed) {
  for (const std::string command : {"explain", "compare"}) {
    const Ran no_log = Run({command, "/nonexistent.csv", "-m", kMachine});
    EXPECT_EQ(no_log.exit_code, 3);
    EXPECT_THAT(no_log.err, HasSubstr("/nonexistent.csv"));
    const Ran short_log = Run({command, Simulate("short.csv", 3, 1), "-m", kMachine});
    EXPECT_EQ(short_log.exit_code, 3);
    EXPECT_THAT(short_log.err, HasSubstr("strokes"));
  }
}

/// Its rows would count twice, and every interval come out by a root of two too narrow.
TEST_F(Workbench, ALogThatIsGivenTwiceIsRefused) {
  const std::string log = Simulate("once.csv", 20, 3), copy = File("copy.csv");
  std::filesystem::copy_file(log, copy);
  for (const char* command : {"fit", "compare", "explain"}) {
    const Ran ran = Run({command, log, copy, "-m", kMachine});
    EXPECT_EQ(ran.exit_code, 3) << command;
    EXPECT_THAT(ran.err, AllOf(HasSubstr("copy.csv: the same recording as"), HasSubstr("once.csv")))
        << command;
  }
  EXPECT_THAT(Run({"fit", log, copy, "-m", kMachine, "--hold-out", "copy.csv"}).err,
              HasSubstr("the same recording as"));
}

}  // namespace
}  // namespace hydroscope
