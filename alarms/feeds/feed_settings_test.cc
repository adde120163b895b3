#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "alarms/feeds/dds/settings.h"
#include "alarms/feeds/modbus/settings.h"
#include "alarms/feeds/sparkplug/settings.h"
#include "models/ipv4_range.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kPress = R"([signals]
p_A = { column = "p", unit = "Pa" }
z = { column = "z", unit = "m" }
y_v = "y"
[geometry]
A_A = 0.0125
dp_nom = 35e5
)";

Machine Loaded(const std::string& feeds) {
  const auto machine = ParseMachine(kPress + feeds, "feeds.toml");
  if (!machine) ADD_FAILURE() << machine.error().text;
  return machine.value_or(Machine{});
}

std::string Refusal(const std::string& feeds) {
  const auto machine = ParseMachine(kPress + feeds, "feeds.toml");
  return machine ? "accepted" : machine.error().text;
}

TEST(FeedSections, AFileWithoutSectionsFeedsNobody) { EXPECT_FALSE(Loaded("").feeds); }

TEST(FeedSections, AnEmptySectionTurnsAFeedOnForThisComputerOnly) {
  const Machine machine = Loaded("[feeds.modbus]\n[feeds.dds]\n[feeds.sparkplug]\n");
  EXPECT_EQ(machine.feeds->Of<ModbusFeedSpec>()->host, "127.0.0.1");
  EXPECT_THAT(machine.feeds->Of<ModbusFeedSpec>()->allow, ElementsAre("127.0.0.0/8"));
  EXPECT_THAT(machine.feeds->Of<DdsFeedSpec>()->interfaces, ElementsAre("127.0.0.1"));
  EXPECT_EQ(machine.feeds->Of<SparkplugFeedSpec>()->broker, "tcp://127.0.0.1:1883");
}

TEST(FeedSections, ReadsBackEqualAfterWriting) {
  const Machine machine = Loaded(
      "[feeds.modbus]\nhost = \"0.0.0.0\"\nport = 502\nacknowledge = false\nallow = [\"10.0.0.0/8\", "
      "\"192.168.0.7\"]\n"
      "[feeds.dds]\ndomain = 3\nsecurity = \"/etc/dds\"\ntransport = \"udp\"\ninterfaces = []\n"
      "[feeds.sparkplug]\nnode = \"press_7\"\nuser = \"u\"\npassword_file = \"/etc/p\"\n"
      "primary_host = \"scada\"\nbroker = \"ssl://10.0.0.1:8883\"\nca_file = \"/etc/ca.pem\"\n"
      "certificate_file = \"/etc/c.pem\"\nkey_file = \"/etc/k.pem\"\n");
  const auto again = ParseMachine(FormatMachine(machine), "written");
  ASSERT_TRUE(again) << again.error().text << "\n" << FormatMachine(machine);
  EXPECT_EQ(machine, *again);
}

TEST(FeedSections, AnAddressRangeHoldsWhatItsPrefixSays) {
  EXPECT_TRUE(ParseIpv4Range("192.168.1.0/24")->Contains(0xc0a801fe));
  EXPECT_FALSE(ParseIpv4Range("192.168.1.0/24")->Contains(0xc0a802fe));
  EXPECT_TRUE(ParseIpv4Range("0.0.0.0/0")->Contains(0x01020304));
  EXPECT_FALSE(ParseIpv4Range("127.0.0.1")->Contains(0x7f000002));
}

TEST(FeedsDamage, WhatIsNoAddressRangeIsRefused) {
  for (const char* text : {"", "1.2.3", "1.2.3.4.5", "256.1.1.1", "1.2.3.4/33", "1.2.3.4/24", "1.2.3.4 ",
                           "::1", "a.b.c.d", "1..2.3", "-1.2.3.4", "1.2.3.4/"})
    EXPECT_FALSE(ParseIpv4Range(text)) << text;
}

TEST(FeedsDamage, AnUnknownKeyIsToldWithTheNearestOne) {
  EXPECT_THAT(Refusal("[feeds.modbus]\nprot = 502\n"),
              AllOf(HasSubstr("feeds.toml:9"), HasSubstr("did you mean \"port\"")));
  EXPECT_THAT(Refusal("[feeds.sparkplg]\n"), HasSubstr("did you mean \"sparkplug\""));
}

TEST(FeedsDamage, AValueThatCannotBeIsRefused) {
  EXPECT_THAT(Refusal("[feeds.modbus]\nallow = [\"plc\"]\n"), HasSubstr("\"plc\" is neither"));
  EXPECT_THAT(Refusal("[feeds.modbus]\nhost = \"plc\"\n"), HasSubstr("an IPv4 address"));
  EXPECT_THAT(Refusal("[feeds.modbus]\nidle_timeout = 0\n"), HasSubstr("greater than 0"));
  EXPECT_THAT(Refusal("[feeds.sparkplug]\nbroker = \"127.0.0.1\"\n"), HasSubstr("tcp://HOST:PORT"));
  EXPECT_THAT(Refusal("[feeds.sparkplug]\ngroup = \"a/b\"\n"), HasSubstr("without /"));
  EXPECT_THAT(Refusal("[feeds.sparkplug]\nprimary_host = \"a/b\"\n"), HasSubstr("without /"));
  EXPECT_THAT(Refusal("[feeds.sparkplug]\nca_file = \"ca.pem\"\n"), HasSubstr("ssl://"));
  EXPECT_THAT(Refusal("[feeds.sparkplug]\nbroker = \"ssl://h:1\"\nkey_file = \"k.pem\"\n"),
              HasSubstr("go together"));
}

}  // namespace
}  // namespace hydroscope
