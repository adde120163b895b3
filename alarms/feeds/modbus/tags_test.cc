#include "alarms/feeds/modbus/tags.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "alarms/feeds/modbus/register_image.h"
#include "alarms/feeds/modbus/register_map.h"

namespace hydroscope {
namespace {

AxisPicture LeakingAxis() {
  AxisPicture axis;
  axis.machine = "press/left";
  axis.name = "left";
  axis.strokes = 70'000;
  TrendPoint point;
  point.time = 990;
  point.oil_temperature = 313.15;
  point.estimate = {"K", 1.5e9, 2e6, "Pa", 1, 980, EstimateReason::kUpdated, 310.15};
  axis.estimates = {point};
  AlarmState alarm;
  alarm.id = "internal_leakage";
  alarm.active = true;
  alarm.acknowledged = false;
  alarm.value = 3e-12;
  alarm.unit = "m3/(s Pa)";
  axis.alarms = {alarm};
  return axis;
}

AxisPicture OtherAxis() {
  AxisPicture right;
  right.machine = "press/right";
  right.name = "right";
  return right;
}

std::vector<Tag> TagsOfAPress(const CountedWords& counted = {}) {
  return ModbusTags({LeakingAxis(), OtherAxis()},
                    {{"press/right", "no_samples"}, {"press/left", "internal_leakage"}}, 1000, counted);
}

const Tag& Named(const std::vector<Tag>& tags, const std::string& axis, const std::string& name) {
  const auto found =
      std::find_if(tags.begin(), tags.end(), [&](const Tag& t) { return t.axis == axis && t.name == name; });
  static const Tag kNone;
  EXPECT_NE(found, tags.end()) << axis << " " << name;
  return found == tags.end() ? kNone : *found;
}

TEST(ModbusTags, StandWhereTheMapHasThemWithTheirValues) {
  const auto tags = TagsOfAPress();
  const Tag& k = Named(tags, "press/left", "K, value");
  EXPECT_EQ(k.address, std::to_string(register_map::kFirstAxis + register_map::kFirstParameter));
  EXPECT_EQ(k.type, "float32");
  EXPECT_EQ(k.unit, "Pa");
  EXPECT_EQ(k.value, "1.5e+09");
  EXPECT_EQ(Named(tags, "press/left", "strokes stored").value, "70000");
  EXPECT_EQ(Named(tags, "press/left", "oil temperature").value, "40");
  EXPECT_EQ(Named(tags, "press/right", "name").value, "right");
  EXPECT_EQ(Named(tags, "press/right", "health").address,
            std::to_string(register_map::kFirstAxis + register_map::kAxisStride));
  EXPECT_EQ(Named(tags, "", "alarms not acknowledged").value, "1");
  EXPECT_EQ(Named(tags, "", "heartbeat").value, "") << "nothing is served";
}

TEST(ModbusTags, WhatARunningFeedServesIsReadFromItsRegisters) {
  const std::vector<ServedRegisters> served = {{3, {4711, 1, 2}},
                                               {1024, {0x4220, 0, 0x6C65, 0x6674, 0, 0, 0, 0, 0, 0}}};
  EXPECT_EQ(ServedValue(served, 3, "u16"), "4711");
  EXPECT_EQ(ServedValue(served, 4, "u32"), "65538");
  EXPECT_EQ(ServedValue(served, 1024, "float32"), "40");
  EXPECT_EQ(ServedValue(served, 1026, "text, 16 characters"), "left");
  EXPECT_EQ(ServedValue(served, 5, "u32"), std::nullopt) << "half of it";
  EXPECT_EQ(ServedValue(served, 2, "u16"), std::nullopt);
  EXPECT_EQ(ServedValue(served, 3, "Double"), std::nullopt);
}

TEST(ModbusTags, EveryTagStandsInTheRegistersThatARunningFeedTellsOf) {
  RegisterImage image;
  image.ShowAxis(1, LeakingAxis(), 1000);
  image.ShowAxis(2, OtherAxis(), 1000);
  image.ShowHead({.axes = 2, .alarms = 2}, 1000);
  const auto served = image.Filled();
  for (const Tag& tag : TagsOfAPress()) {
    const auto value = ServedValue(served, std::stoi(tag.address), tag.type);
    EXPECT_TRUE(value) << tag.address << " " << tag.name;
  }
  EXPECT_EQ(ServedValue(served, register_map::kFirstAxis + register_map::kFirstParameter, "float32"),
            "1.5e+09");
}

TEST(ModbusTags, AnAlarmHasTheNumberOfItsFirstAppearance) {
  const auto tags = TagsOfAPress();
  const Tag& state = Named(tags, "press/left", "alarm 2 internal_leakage, state");
  EXPECT_EQ(state.address, std::to_string(register_map::kFirstAlarm + register_map::kAlarmStride + 1));
  EXPECT_EQ(state.value, "1");
  EXPECT_EQ(Named(tags, "press/left", "alarm 2 internal_leakage, value").unit, "m3/(s Pa)");
}

TEST(ModbusTags, NamesSpeakOfEpisodesWhereTheMachineHasThemAndNoAddressMoves) {
  const auto strokes = TagsOfAPress(), episodes = TagsOfAPress(kEpisodes);
  ASSERT_EQ(episodes.size(), strokes.size());
  for (std::size_t k = 0; k < episodes.size(); ++k) {
    EXPECT_EQ(episodes[k].address, strokes[k].address);
    EXPECT_EQ((episodes[k].name + episodes[k].meaning).find("stroke"), std::string::npos) << episodes[k].name;
  }
  EXPECT_EQ(Named(episodes, "press/left", "episodes stored").address,
            Named(strokes, "press/left", "strokes stored").address);
}

TEST(ModbusTags, StandInOrderAndNoRegisterIsNamedTwice) {
  int before = -1;
  for (const Tag& tag : TagsOfAPress()) {
    EXPECT_GT(std::stoi(tag.address), before) << tag.name;
    before = std::stoi(tag.address);
  }
}

}  // namespace
}  // namespace hydroscope
