#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ConfoundedCommand : public CommandLine {
 protected:
  /// `log` replayed into a database of its own; what `replay` says.
  Ran Replay(const std::string& log, const std::string& db, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"replay", log, "-m", kMachine, "--db", File(db)};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = Run(words);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return ran;
  }
  /// What `trends --json` sums up of a parameter.
  nlohmann::json Summary(const std::string& db, const std::string& parameter) {
    const nlohmann::json trends = Run({"trends", "--db", File(db), "--json", "-"}).Json();
    for (const nlohmann::json& summary : trends["summary"])
      if (summary["parameter"] == parameter) return summary;
    return nullptr;
  }
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

void ExpectConfounded(const nlohmann::json& q) {
  EXPECT_EQ(q["reason"], "confounded") << q.dump(1);
  ASSERT_TRUE(q.contains("confounded_with")) << q.dump(1);
  EXPECT_THAT(q["confounded_with"], Contains("internal_leakage"));
  EXPECT_THAT(q["advice"].get<std::string>(), HasSubstr("vary ram speed"));
}

TEST_F(ConfoundedCommand, ADatabaseAndTheTableOfExplainSayTheSame) {
  const std::string log = Simulate("one_speed.csv", 90, 5, {"--speed-min", "50", "--speed-max", "50"});
  const nlohmann::json explained = Run({"explain", log, "-m", kMachine, "--json", "-"}).Json();
  EXPECT_EQ(explained["verdict"], "adequate");
  ExpectConfounded(explained["base"]["parameters"]["Q_vn"]);
  ExpectConfounded(explained["final"]["parameters"]["Q_vn"]);
  EXPECT_THAT(Run({"explain", log, "-m", kMachine}).out,
              AllOf(HasSubstr("NOT IDENTIFIABLE: Q_vn: confounded with"), Not(HasSubstr("Nothing to do"))));

  const nlohmann::json replayed = Replay(log, "a.db", {"--json", "-", "--report", File("a.html")}).Json();
  ExpectConfounded(replayed["parameters"]["Q_vn"]);
  EXPECT_THAT(Replay(log, "a.db").out, HasSubstr("NOT IDENTIFIABLE: confounded with"));
  EXPECT_THAT(ReadText(File("a.html")), HasSubstr("<dt>Not identifiable</dt>"));
  EXPECT_THAT(ReadText(File("a.html")), HasSubstr("<b>Not identifiable:</b> Q_vn: confounded with"));
  ExpectConfounded(Summary("a.db", "Q_vn"));
  EXPECT_THAT(
      Run({"trends", "--db", File("a.db")}).out,
      AllOf(HasSubstr("\nNot identifiable\n"), HasSubstr("\nQ_vn: confounded with internal_leakage")));
  ExpectConfounded(
      Run({"explain", "--db", File("a.db"), "--json", "-"}).Json()["base"]["parameters"]["Q_vn"]);
  EXPECT_THAT(Run({"explain", "--db", File("a.db")}).out,
              HasSubstr("NOT IDENTIFIABLE: Q_vn: confounded with"));
}

// 0.5 % of the area, which V0 and Q_vn share in proportion; a change from stroke to stroke is judged without.
TEST_F(ConfoundedCommand, ADatabaseStatesTheToleranceOfTheAreaAsFitDoes) {
  const std::string log = Simulate("varied.csv", 90, 3);
  const nlohmann::json q = Parameters("fit", log)["Q_vn"];
  const double least = 0.005 * q["value"].get<double>();
  const nlohmann::json replayed = Replay(log, "a.db", {"--json", "-", "--report", File("a.html")}).Json();
  EXPECT_GT(replayed["parameters"]["Q_vn"]["std"].get<double>(), least);
  EXPECT_EQ(replayed["parameters"]["Q_vn"]["identifiable"], true);
  EXPECT_EQ(replayed["assumed_tolerances"][0]["name"], "A_A");
  EXPECT_EQ(Summary("a.db", "Q_vn")["std"], replayed["parameters"]["Q_vn"]["std"]);
  EXPECT_THAT(Run({"trends", "--db", File("a.db")}).out, HasSubstr("A_A has no tolerance"));
  const nlohmann::json explained = Run({"explain", "--db", File("a.db"), "--json", "-"}).Json();
  EXPECT_GT(explained["base"]["parameters"]["Q_vn"]["std"].get<double>(), least);
  const nlohmann::json since =
      Run({"explain", "--db", File("a.db"), "--since", "8", "--json", "-"}).Json()["change"];
  EXPECT_GT(since["after"]["parameters"]["Q_vn"]["std"].get<double>(), least);
  EXPECT_LT(since["parameters"]["Q_vn"]["change"]["std"].get<double>(), least);
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
