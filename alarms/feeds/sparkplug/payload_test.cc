#include "alarms/feeds/sparkplug/payload.h"

#include <gtest/gtest.h>

#include "alarms/feeds/sparkplug/tags.h"

namespace hydroscope {
namespace {

TEST(SparkplugPayload, AsksForRebirthOnlyWithTheCommandAndTrue) {
  // A node birth carries the same metric, with the value false.
  EXPECT_FALSE(sparkplug::AsksForRebirth(sparkplug::NodeBirth(1, 1)));
  EXPECT_FALSE(sparkplug::AsksForRebirth("nonsense"));
  const std::string name = "Node Control/Rebirth";
  std::string metric = "\x0a" + std::string(1, static_cast<char>(name.size())) + name + "\x70\x01";
  EXPECT_TRUE(sparkplug::AsksForRebirth("\x12" + std::string(1, static_cast<char>(metric.size())) + metric));
}

TEST(SparkplugPayload, AnEventNamesItsRowAndABirthNone) {
  JournalRow row;
  row.sequence = 70'000'000'000;
  row.event.alarm = "air";
  row.event.comment = "seen";
  const auto told = sparkplug::RowOf(*sparkplug::Sealed(sparkplug::Event(row), 3, true));
  ASSERT_TRUE(told);
  EXPECT_EQ(told->sequence, row.sequence);
  EXPECT_EQ(told->alarm, "air");
  EXPECT_EQ(told->comment, "seen");
  EXPECT_FALSE(sparkplug::RowOf(sparkplug::DeviceBirth({}, 1)));
}

TEST(SparkplugPayload, NonsenseIsNotSealed) { EXPECT_FALSE(sparkplug::Sealed("\xff\xff\xff", 1, false)); }

TEST(SparkplugPayload, SealingTwiceLeavesTheLastNumber) {
  const std::string event = sparkplug::Event({});
  EXPECT_EQ(*sparkplug::Sealed(*sparkplug::Sealed(event, 7, false), 9, false),
            *sparkplug::Sealed(event, 9, false));
}

TEST(SparkplugPayload, TagsAreTheMetricsOfABirth) {
  AxisPicture axis;
  axis.name = "left";
  axis.strokes = 152;
  TrendPoint point;
  point.oil_temperature = 313.15;
  point.estimate = {"K", 1.5e9, 2e6, "Pa", 1, 980, EstimateReason::kUpdated, 310.15};
  axis.estimates = {point};
  const auto tags = SparkplugTags({}, "hall/press", {axis}, 1000);
  const auto named = [&](const std::string& name) {
    for (const Tag& tag : tags)
      if (tag.name == name) return tag;
    ADD_FAILURE() << name;
    return Tag{};
  };
  EXPECT_EQ(named("Parameters/K").address, "spBv1.0/hydroscope/DDATA/hall_press/left");
  EXPECT_EQ(named("Parameters/K").unit, "Pa");
  EXPECT_EQ(named("Parameters/K").type, "Double");
  EXPECT_EQ(named("Parameters/K").value, "1.5e+09");
  EXPECT_EQ(named("Strokes").value, "152");
  EXPECT_EQ(named("Event/Sequence").value, "") << "no event happens now";
  EXPECT_TRUE(sparkplug::TagsOf("nonsense").empty());
}

TEST(SparkplugPayload, NamesLoseWhatTopicsDoNotAllow) {
  EXPECT_EQ(sparkplug::TopicPart("hall/press #3+"), "hall_press _3_");
}

}  // namespace
}  // namespace hydroscope
