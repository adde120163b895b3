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

TEST_F(StatesDrift, OfEpisodesShortAgainstTheMemoryIsFollowedToo) {
  period_ = 1e-3;
  rows_ = 100;
  Replay(0.002);
  EXPECT_THAT(Coverage(0.002), Each(Gt(0.85)));
}

TEST_F(StatesDrift, IsNotSeenInAHealthyMachine) {
  Replay(0);
  EXPECT_THAT(Run({"alarms", "--db", File("tank.db"), "list"}).out, HasSubstr("no alarm stands"));
}

}  // namespace
}  // namespace hydroscope::command_line_test
