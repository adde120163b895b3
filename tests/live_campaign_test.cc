// Short forms of the live campaigns: what must hold on any machine, however busy. Times are judged by the
// campaigns themselves (`hydroscope benchmark live-latency`, `live-kill --times 200`).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::ContainsRegex;

TEST_F(CommandLine, AServiceKilledTwiceKeepsEveryAcknowledgedStepOnce) {
  const Ran ran = Run({"benchmark", "live-kill", "--times", "2"});
  EXPECT_THAT(ran.out, ContainsRegex("acknowledged and missing, or there twice +0 ")) << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("starts without data within 10 s +0 "));
  EXPECT_THAT(ran.out, ContainsRegex("exit code after SIGTERM +0 "));
}

TEST_F(CommandLine, TheServiceLosesNothingAndItsRawWindowReplaysToTheSame) {
  const Ran ran = Run({"benchmark", "live-latency", "--axes", "2", "--rate", "500", "--seconds", "6"});
  EXPECT_THAT(ran.out, ContainsRegex("rows missing +0 ")) << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("dropped in queues +0 "));
  EXPECT_THAT(ran.out, ContainsRegex("the same to the last bit +2 of 2 "));
}

TEST_F(CommandLine, AnOperatorSeesEveryFaultInEveryPlace) {
  const Ran ran = Run({"benchmark", "live-faults", "--brief"});
  if (ran.err.find("needs the MQTT broker") != std::string::npos) GTEST_SKIP() << ran.err;
  for (const char* fault :
       {"two senders of the same channels", "140 forged batches", "link lost while the press works",
        "database deleted", "database overwritten in part"})
    EXPECT_THAT(ran.out,
                ContainsRegex(std::string(fault) + "[^\n]*: log [0-9.]+ s, status [0-9.]+ s, registers "
                                                   "[0-9.]+ s, Sparkplug [0-9.]+ s, DDS [0-9.]+ s"))
        << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("16 idle Modbus clients and one more +[0-9.]+ s +reached"));
  EXPECT_THAT(ran.out, ContainsRegex("service killed .kill -9., started again +[0-9.]+ s +reached"));
  if (ran.out.find("libfaketime is not installed") == std::string::npos) {
    EXPECT_THAT(ran.out, ContainsRegex("clock of the computer of both -2h +[0-9.]+ s +reached: no row lost"));
  }
}

TEST_F(CommandLine, StatusWithoutAServiceSaysWhatToStart) {
  const Ran ran = Run({"status", "--db", File("nobody.db")});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, testing::HasSubstr("hydroscope serve"));
}

}  // namespace
}  // namespace hydroscope
