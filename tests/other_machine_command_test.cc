// A machine file, a database and logs that do not belong together are told of.

#include "tests/tank_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class OtherMachine : public CommandLine {};

TEST_F(OtherMachine, AMachineFileOfAnotherKindIsToldToBe) {
  ASSERT_EQ(Run({"replay", Simulate("a.csv", 60, 1), "-m", kMachine, "--db", File("press.db")}).exit_code, 0);
  const std::string pump = std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/pump.toml";
  for (const char* command : {"explain", "compare"}) {
    const Ran ran = Run({command, "--db", File("press.db"), "-m", pump});
    EXPECT_EQ(ran.exit_code, 3) << command;
    EXPECT_THAT(ran.err, AllOf(HasSubstr("strokes of die_cushion are those of a die cushion"),
                               HasSubstr("pump"), Not(HasSubstr("sums of products"))))
        << command;
  }
}

TEST_F(OtherMachine, AChangeWhereALogBeginsMayBeAnotherMachine) {
  const std::string one = Simulate("one.csv", 120, 1), two = Simulate("two.csv", 120, 2),
                    other = Simulate("other.csv", 120, 11, {"--random-machine", "11"});
  const std::vector<std::string> into = {"-m", kMachine, "--db", File("press.db")};
  const auto replay = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "replay");
    words.insert(words.end(), into.begin(), into.end());
    const Ran ran = Run(words);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    return ran.out;
  };
  EXPECT_THAT(replay({one, two}), Not(HasSubstr("another machine")));
  EXPECT_THAT(replay({other}), AllOf(HasSubstr("hold a change"), HasSubstr("other.csv begins there"),
                                     HasSubstr("if it is of another machine")));
  EXPECT_THAT(replay({other}), Not(HasSubstr("another machine"))) << "it was told when the log was stored";
  const std::string text = Run({"explain", "--db", File("press.db")}).out;
  EXPECT_THAT(text, AllOf(HasSubstr("These strokes hold a change"), HasSubstr("other.csv begins there"),
                          HasSubstr("if it is of another machine")));
}

/// The same laws as `explain` has: the second tank's sensor ends, and the pump's reading hangs for a while.
class StatesReplay : public Tanks {
 protected:
  void WriteLog(bool ends, bool hangs) {
    std::istringstream log(ReadText(Log(0)));
    std::string line, text, held;
    std::mt19937 random(8);
    std::normal_distribution<double> noise(0, 0.03);
    for (int row = -1; std::getline(log, line); ++row) {
      if (row < 0) {
        text += line + "\n";
        continue;
      }
      double t = 0, u = 0, y_1 = 0, y_2 = 0;
      std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &u, &y_1, &y_2);
      const bool hung = hangs && row > 1200 && row < 1600;
      if (!hung) held = fmt::format("{:.4f}", u + noise(random));
      text += fmt::format("{:.6g},{},{:.5f},{:.5f}\n", t, held, y_1, ends ? std::min(y_2, 4.5) : y_2);
    }
    WriteText(File("tank.csv"), text);
    std::string machine = MachineText("tank");
    machine.replace(machine.find("dds = \"u\""), 9, "stuck_time = 30, dds = \"u\"");
    WriteText(File("tank.toml"), machine);
  }
  void ExpectSaid(const std::vector<std::string>& commands, const testing::Matcher<std::string>& said) {
    std::filesystem::remove(File("tank.db"));
    for (const std::string& command : commands) {
      std::vector<std::string> words = {command, File("tank.csv"), "-m", File("tank.toml")};
      if (command == "replay") words.insert(words.end(), {"--db", File("tank.db")});
      const Ran ran = Run(words);
      EXPECT_TRUE(ran.exit_code == 0 || command == "check") << ran.err;
      EXPECT_THAT(ran.out + ran.err, said) << command;
    }
  }
};

TEST_F(StatesReplay, LeavesOutWhatSensorsThatEndReadAsExplainDoes) {
  episodes_ = 12;
  change_ = 1000;
  noise_ = 5e-4;  // so little that none is seen to be cut off
  WriteLog(true, false);
  ExpectSaid({"check", "fit", "explain", "replay"},
             HasSubstr("level_2 stands at its highest reading, 4.5 V"));
}

TEST_F(StatesReplay, LeavesOutAnInputThatHungAsExplainDoes) {
  episodes_ = 12;
  change_ = 1000;
  WriteLog(false, true);
  ExpectSaid({"check", "fit", "replay"}, HasSubstr("u (column u) repeats one reading from 120"));
}

TEST_F(StatesReplay, OfASoundLogSaysNothingOfSensors) {
  episodes_ = 12;
  change_ = 1000;
  WriteLog(false, false);
  ExpectSaid({"check", "fit", "replay"},
             AllOf(Not(HasSubstr("stands at")), Not(HasSubstr("repeats one reading")),
                   Not(HasSubstr("one and the same"))));
}

}  // namespace
}  // namespace hydroscope::command_line_test
