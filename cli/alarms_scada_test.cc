#include "cli/alarms_scada.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

std::string ValueOf(const std::string& alarm, double value, double std) {
  ScadaAlarm read;
  read.name = alarm;
  read.value = value;
  read.std = std;
  return ScadaAlarmValue(read);
}

TEST(AlarmsScada, ValuesAreInTheUnitOfWhatTheAlarmIsCalledBy) {
  EXPECT_EQ(ValueOf("internal_leakage", 2e-12, 1e-14), "0.01200 ± 0.00012 l/min per bar");
  EXPECT_EQ(ValueOf("V0", 1.65e-3, 1e-5), "1.650 ± 0.020 l");
  EXPECT_EQ(ValueOf("an_alarm_of_the_plant", 3, 0.1), "3.00 ± 0.20 SI");
  EXPECT_EQ(ValueOf("an_alarm_of_the_plant", 3, 0), "3 SI") << "no interval that would read ± 0.00000";
  ScadaAlarm senders;
  senders.name = "two_senders";
  senders.severity = "signal_loss";
  senders.value = 2;
  EXPECT_EQ(ScadaAlarmValue(senders), "");
}

}  // namespace
}  // namespace hydroscope
