#include "alarms/feeds/sparkplug/payload.h"

#include <gtest/gtest.h>

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

TEST(SparkplugPayload, NonsenseIsNotSealed) { EXPECT_FALSE(sparkplug::Sealed("\xff\xff\xff", 1, false)); }

TEST(SparkplugPayload, SealingTwiceLeavesTheLastNumber) {
  const std::string event = sparkplug::Event({});
  EXPECT_EQ(*sparkplug::Sealed(*sparkplug::Sealed(event, 7, false), 9, false),
            *sparkplug::Sealed(event, 9, false));
}

TEST(SparkplugPayload, NamesLoseWhatTopicsDoNotAllow) {
  EXPECT_EQ(sparkplug::TopicPart("hall/press #3+"), "hall_press _3_");
}

}  // namespace
}  // namespace hydroscope
