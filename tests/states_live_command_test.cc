// A machine with states, watched live: a log of it is sent as if it were at work, by processes of their own.
#include "storage/file_identity.h"
#include "tests/program_process.h"
#include "tests/tank_fixture.h"

namespace hydroscope::command_line_test {
namespace {

using testing::ContainsRegex;
using testing::Each;
using testing::Gt;
using testing::HasSubstr;
using testing::Not;

class StatesLive : public Tanks {
 protected:
  void SetUp() override {
    Tanks::SetUp();
    episodes_ = 240;
    rows_ = 100;
    period_ = 1e-3;
    WriteText(File("tank.toml"), MachineText("tank"));
  }
};

TEST_F(StatesLive, IsFollowedWhileItWorksAndItsDriftRaised) {
  constexpr double kRate = 0.004;
  Program tank({"simulate", "log", Log(kRate), "--serve", File("tank.toml")}, File("sent"));
  ASSERT_TRUE(tank.WaitFor("waiting for a reader: 3 signals at 1000 Hz")) << ReadText(File("sent.err"));
  Program service({"serve", File("tank.toml"), "--db", File("tank.db"), "--port", "0"}, File("served"));
  EXPECT_EQ(tank.Wait(), 0);
  EXPECT_THAT(ReadText(File("sent")), HasSubstr("sent 24000 rows, 0 dropped"));
  EXPECT_TRUE(WaitUntil([&] {
    return Run({"alarms", "--db", File("tank.db"), "list"}).out.find("unnamed_change_k2") !=
           std::string::npos;
  })) << Run({"alarms", "--db", File("tank.db"), "list"}).out
      << Run({"status", "--db", File("tank.db")}).out;
  const FileIdentity log = FileIdentity::Of(File("tank.db-wal"));
  ASSERT_TRUE(log.exists());
  EXPECT_EQ(Run({"status", "--db", File("tank.db")}).exit_code, 0);
  // Who closes the database leaves its write-ahead log to the service.
  EXPECT_TRUE(log == FileIdentity::Of(File("tank.db-wal")));
  EXPECT_EQ(service.Kill(SIGTERM), 0);
  SCOPED_TRACE(ReadText(File("served.err")));
  const std::string alarms = Run({"alarms", "--db", File("tank.db"), "list"}).out;
  EXPECT_THAT(alarms, Not(HasSubstr("unnamed_change_k1")));
  EXPECT_THAT(alarms, ContainsRegex("k2 -[1-4][0-9]\\.[0-9]+ ± [0-9.]+ %"));  // not per cent of the number 1
  EXPECT_THAT(Coverage(kRate), Each(Gt(0.85)));

  const std::string learned =
      Run({"learn", "--db", File("tank.db"), "-m", File("tank.toml"), "--from", "1", "--to", "111"}).out;
  EXPECT_THAT(learned, HasSubstr("reference 2 learned from episodes 1 to 110"));
  EXPECT_THAT(learned, Not(HasSubstr("nan")));
}

TEST_F(StatesLive, ALogThatNobodyCouldSendIsRefused) {
  WriteText(File("nowhere.toml"), "[machine]\nmodel = \"valve\"\n[signals]\nU_v = \"u\"\ny_v = \"y_1\"\n");
  const Ran nowhere = Run({"simulate", "log", Log(0), "--serve", File("nowhere.toml")});
  EXPECT_NE(nowhere.exit_code, 0);
  EXPECT_THAT(nowhere.err, HasSubstr("[live.dds]"));
}

}  // namespace
}  // namespace hydroscope::command_line_test
