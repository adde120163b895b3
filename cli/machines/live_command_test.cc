#include "cli/machines/live_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

template <typename Command>
Command Parsed(const std::string& line) {
  const auto command = ParseLiveCommand(line);
  if (!command || !std::holds_alternative<Command>(*command)) {
    ADD_FAILURE() << line << ": " << (command ? "another command" : command.error().text);
    return {};
  }
  return std::get<Command>(*command);
}
std::string Refusal(const std::string& line) {
  const auto command = ParseLiveCommand(line);
  return command ? "accepted" : command.error().text;
}

TEST(LiveCommand, AnEffectHasSizeAxisAndRamp) {
  const auto command = Parsed<ChangeEffectCommand>("effect relief_valve=2e-11,crack=170e5 axis=3 ramp=60");
  EXPECT_EQ(command.effect.id, "relief_valve");
  EXPECT_DOUBLE_EQ(command.effect.size, 2e-11);
  EXPECT_DOUBLE_EQ(command.effect.extra.at("crack"), 170e5);
  EXPECT_EQ(command.axis, 2);
  EXPECT_DOUBLE_EQ(command.ramp, 60);
  EXPECT_EQ(Parsed<ChangeEffectCommand>("effect internal_leakage").axis, -1) << "all axes";
}

TEST(LiveCommand, AFaultHasAnAxis) {
  const auto command = Parsed<AddFaultCommand>("fault stuck:p_A:5:2 axis=1");
  EXPECT_EQ(command.fault.kind, FaultKind::kStuck);
  EXPECT_DOUBLE_EQ(command.fault.start, 5);
  EXPECT_EQ(command.axis, 0);
}

TEST(LiveCommand, TheWireHasFaultsToo) {
  EXPECT_TRUE(Parsed<PauseCommand>("pause").pause);
  EXPECT_FALSE(Parsed<PauseCommand>(" run ").pause);
  EXPECT_TRUE(Parsed<FreezeCommand>("freeze").freeze);
  EXPECT_TRUE(Parsed<MuteCommand>("dds mute").mute);
  EXPECT_EQ(Parsed<ModbusFaultCommand>("modbus garbage").fault, ModbusFault::kGarbage);
  EXPECT_DOUBLE_EQ(Parsed<ModbusFaultCommand>("modbus late=0.5").delay, 0.5);
  EXPECT_DOUBLE_EQ(Parsed<ClockCommand>("clock -3600").jump, -3600);
  EXPECT_DOUBLE_EQ(Parsed<ClockCommand>("clock 315576000").jump, 315576000) << "ten years";
  Parsed<QuitCommand>("quit");
}

TEST(LiveCommand, WhatIsNotUnderstoodIsNamedWithWhatIs) {
  EXPECT_THAT(Refusal("effect relief_valve axis=0"), HasSubstr("from 1 on"));
  EXPECT_THAT(Refusal("effect relief_valve axle=2"), HasSubstr("axis=NUMBER or ramp=NUMBER"));
  EXPECT_THAT(Refusal("fault broken:p_A:1:2"), HasSubstr("offset_drift"));
  EXPECT_THAT(Refusal("modbus late=never"), HasSubstr("late=SECONDS"));
  EXPECT_THAT(Refusal("dance"), HasSubstr("pause | run"));
  EXPECT_THAT(Refusal(""), HasSubstr("empty line"));
  EXPECT_THAT(Refusal("clock soon"), HasSubstr("clock S"));
}

}  // namespace
}  // namespace hydroscope
