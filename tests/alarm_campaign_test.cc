// Short forms of the alarm campaigns (`hydroscope benchmark alarm-kill --times 200`, `alarm-burst`).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::ContainsRegex;
using testing::HasSubstr;

bool HasBroker() {
  return std::filesystem::exists("/usr/sbin/mosquitto") || std::filesystem::exists("/usr/bin/mosquitto");
}

TEST_F(CommandLine, AKilledAlarmSystemKeepsEveryRowAndDeliversItAtLeastOnce) {
  if (!HasBroker()) GTEST_SKIP() << "mosquitto is not installed; scripts/setup.sh installs it";
  const Ran ran = Run({"benchmark", "alarm-kill", "--times", "4"});
  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("acknowledged and missing +0 "));
  EXPECT_THAT(ran.out, ContainsRegex("rows the broker never passed on +0 "));
  EXPECT_THAT(ran.out, ContainsRegex("rows it got that the journal does not have so +0 "));
}

TEST_F(CommandLine, AThousandAlarmsInASecondReachEveryone) {
  if (!HasBroker()) GTEST_SKIP() << "mosquitto is not installed; scripts/setup.sh installs it";
  const Ran ran = Run({"benchmark", "alarm-burst"});
  EXPECT_EQ(ran.exit_code, 0) << ran.out << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("Modbus: rows missed +0 "));
  EXPECT_THAT(ran.out, ContainsRegex("DDS: events the reader got +1000 "));
}

TEST_F(CommandLine, AScadaSystemThatFindsNobodyIsToldWhatToStart) {
  const Ran nobody = Run({"alarms", "--modbus", "127.0.0.1:1"});
  EXPECT_EQ(nobody.exit_code, 3);
  EXPECT_THAT(nobody.err, HasSubstr("[feeds.modbus]"));
  EXPECT_EQ(Run({"alarms", "--modbus", "127.0.0.1"}).exit_code, 2);
  EXPECT_EQ(Run({"alarms", "--ack", "1"}).exit_code, 2);
  EXPECT_EQ(Run({"alarms", "list"}).exit_code, 2);
}

}  // namespace
}  // namespace hydroscope
