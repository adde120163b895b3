#include "tests/tank_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using testing::Each;
using testing::Gt;
using testing::HasSubstr;
using testing::Not;

class StatesDrift : public Tanks {
 protected:
  void Replay(double rate) {
    WriteText(File("tank.toml"), MachineText("tank"));
    const auto run = Run({"replay", Log(rate), "-m", File("tank.toml"), "--db", File("tank.db"), "--report",
                          File("tank.html")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
};

TEST_F(StatesDrift, IsFollowedAndNamed) {
  Replay(0.002);
  const std::string alarms = Run({"alarms", "--db", File("tank.db"), "list"}).out;
  EXPECT_THAT(alarms, HasSubstr("unnamed_change_k2"));
  EXPECT_THAT(alarms, Not(HasSubstr("unnamed_change_k1")));
  EXPECT_THAT(alarms, Not(HasSubstr("unnamed_change_pump")));
  EXPECT_THAT(ReadText(File("tank.html")), HasSubstr("k2"));
  EXPECT_THAT(Coverage(0.002), Each(Gt(0.85)));
}

/// A page as people read it: no markup.
std::string Words(std::string page) {
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{"<style>", "</style>"}, {"<script>", "</script>"}, {"<", ">"}})
    for (std::size_t at = page.find(from); at != page.npos; at = page.find(from, at))
      page.erase(at, page.find(to, at) + to.size() - at);
  return page;
}

TEST_F(StatesDrift, IsToldAlikeByAllWhoReadTheDatabase) {
  Replay(0.002);
  const std::string replayed = Words(ReadText(File("tank.html")));
  ASSERT_EQ(Run({"report", "--db", File("tank.db"), "--out", File("stored.html")}).exit_code, 0);
  EXPECT_THAT(ReadText(File("tank.html")), HasSubstr("Deviation of k2"))
      << "the rules name no parameter of it";
  for (const std::string& page : {replayed, Words(ReadText(File("stored.html")))}) {
    EXPECT_THAT(page, HasSubstr("◆ changed"));
    EXPECT_THAT(page, HasSubstr("A parameter changed"));
    EXPECT_THAT(page, Not(HasSubstr("No clear change")));
    EXPECT_THAT(page, Not(HasSubstr("misses something")));
    EXPECT_THAT(page, Not(HasSubstr("stroke")));
    EXPECT_THAT(page, Not(HasSubstr("Stroke")));
  }
  const std::string table = Run({"trends", "--db", File("tank.db")}).out;
  EXPECT_THAT(table, HasSubstr("significant"));
  EXPECT_THAT(table, HasSubstr("unnamed_change_k2: stands, since episode"));
  EXPECT_THAT(table, Not(HasSubstr("stroke")));
  const auto trends = nlohmann::json::parse(Run({"trends", "--db", File("tank.db"), "--json", "-"}).out);
  for (const auto& summary : trends.at("summary"))
    EXPECT_EQ(summary.at("change").at("significant"), summary.at("parameter") == "k2") << summary.dump();
  EXPECT_EQ(trends.at("alarms").at(0).at("alarm"), "unnamed_change_k2");
  const std::string compared = Run({"compare", "--db", File("tank.db")}).out;
  EXPECT_THAT(compared, HasSubstr("these episodes hold a change"));
  EXPECT_THAT(compared, Not(HasSubstr("stroke")));
  const std::string explained = Run({"explain", "--db", File("tank.db")}).out;
  EXPECT_THAT(explained, HasSubstr("hold a change since episode"));
  EXPECT_THAT(explained, HasSubstr("changed and goes on changing"));
  const std::string whole = Run({"explain", "--db", File("tank.db"), "--whole"}).out;
  EXPECT_THAT(whole, HasSubstr("these episodes hold a change since episode"));
  const std::string alarms = Run({"alarms", "--db", File("tank.db"), "list"}).out;
  EXPECT_THAT(alarms, HasSubstr("k2 goes on moving"));
  for (const std::string& text : {explained, whole, alarms}) {
    EXPECT_THAT(text, Not(HasSubstr("stroke")));
    EXPECT_THAT(text, Not(HasSubstr("or an effect is missing")));
  }
}

TEST_F(StatesDrift, AnEffectOfTheModelIsOneOfItsParametersToAllWhoReadTheDatabase) {
  episodes_ = 15;
  std::string text = MachineText("tank");
  text.insert(text.find("[log]"), "effects = [\"zero\"]\n");
  WriteText(File("tank.toml"), text +
                                   "[[effect]]\nid = \"zero\"\nadds = { level_2 = \"b\" }\n"
                                   "parameters = { b = { start = 0, min = -20, max = 20 } }\n");
  const auto replay = Run({"replay", Log(0), "-m", File("tank.toml"), "--db", File("tank.db")});
  ASSERT_EQ(replay.exit_code, 0) << replay.err;
  EXPECT_THAT(replay.out, Not(HasSubstr("cannot tell"))) << "a zero error of next to nothing is known well";
  for (const char* command : {"explain", "compare"}) {
    const auto run = Run({command, "--db", File("tank.db")});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.out + run.err, Not(HasSubstr("unknown effect")));
  }
}

/// What the stored sums take for noise is then the error of the model.
TEST_F(StatesDrift, OfAModelThatMissesSomethingFromTheBeginningIsNoAllClear) {
  overflow_ = 0.15;
  Replay(0);
  const auto compared = Run({"compare", "--db", File("tank.db"), "--json", "-"}).Json();
  EXPECT_TRUE(compared.at("model_error_seen").is_null()) << compared.at("model_error_seen");
  EXPECT_GT(compared.at("rms_holdout").get<double>(), 3 * compared.at("noise_floor").get<double>());
  EXPECT_THAT(Run({"compare", "--db", File("tank.db")}).out, Not(HasSubstr("down to the sensor noise")));
  EXPECT_THAT(Run({"compare", "--db", File("tank.db"), "--csv", File("beside.csv")}).err,
              HasSubstr("--csv needs logs, not a database"));
  const auto explained = Run({"explain", "--db", File("tank.db"), "--whole", "--json", "-"}).Json();
  EXPECT_EQ(explained.at("verdict"), "unknown");
  const std::string told = Words(Run({"explain", "--db", File("tank.db"), "--whole"}).out);
  EXPECT_THAT(told, HasSubstr("hydroscope explain LOG... --machine FILE"));
  EXPECT_THAT(told, Not(HasSubstr("check the signals")));
  const std::string page = Words(ReadText(File("tank.html")));
  EXPECT_THAT(page, Not(HasSubstr("about down to what sensor noise")));
  EXPECT_THAT(page, HasSubstr("or the model misses something"));
}

TEST_F(StatesDrift, OfAModelThatMissesSomethingSinceALogIsNoAllClear) {
  episodes_ = 8;
  Replay(0);
  overflow_ = 0.15;
  Replay(0);
  const auto since = Run({"explain", "--db", File("tank.db"), "--since", "8", "--json", "-"}).Json();
  EXPECT_EQ(since.at("verdict"), "unknown");
  EXPECT_LT(since.at("change").at("after").at("noise_floor").get<double>(),
            0.3 * since.at("base").at("rms_holdout").get<double>())
      << "the error is no noise";
}

TEST_F(StatesDrift, OfAModelThatRunsAwayIsSaidToTellOfNoParameter) {
  episodes_ = 3;
  std::string text = MachineText("tank");
  const std::string equation = "pump*u - k1*sqrt(max(h_1, 0))";
  text.replace(text.find(equation), equation.size(), "pump*u + k1*h_1^3");
  WriteText(File("tank.toml"), text);
  const auto replay = Run({"replay", Log(0), "-m", File("tank.toml"), "--db", File("tank.db")});
  EXPECT_THAT(replay.out,
              HasSubstr("3 of 3 episodes tell of no parameter (the model cannot be run through it"));
  const auto trends = Run({"trends", "--db", File("tank.db")});
  EXPECT_THAT(trends.err, HasSubstr("3 episodes of machine \"tank\" stored, none of which tells"));
  EXPECT_THAT(trends.err, Not(HasSubstr("inside the gate")));
}

TEST_F(StatesDrift, OfEpisodesShortAgainstTheMemoryIsFollowedToo) {
  period_ = 1e-3;
  rows_ = 100;
  Replay(0.002);
  EXPECT_THAT(Coverage(0.002), Each(Gt(0.85)));
}

TEST_F(StatesDrift, IsNotSeenInAHealthyMachine) {
  Replay(0);
  EXPECT_THAT(Run({"alarms", "--db", File("tank.db"), "list"}).out, HasSubstr("no alarm stands"));
  EXPECT_THAT(Run({"compare", "--db", File("tank.db")}).out,
              HasSubstr("The model describes these episodes down to the sensor noise."));
  EXPECT_THAT(Run({"explain", "--db", File("tank.db")}).out, HasSubstr("ADEQUATE"));
  const std::string page = Words(ReadText(File("tank.html")));
  EXPECT_THAT(page, HasSubstr("No change stands out in this record"));
  EXPECT_THAT(page, HasSubstr("about down to what sensor noise leaves"));
}

}  // namespace
}  // namespace hydroscope::command_line_test
