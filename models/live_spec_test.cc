#include "models/live_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/dds/settings.h"
#include "acquisition/modbus/settings.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kLive = R"([live]
axes = ["left", "right"]
[live.dds]
domain = 7
senders = ["10.0.0.0/8"]
security = "/etc/dds"
interfaces = ["127.0.0.1"]
[live.modbus]
host = "plc"
port = 1502
ring = { first = 100, records = 64, width = 12, poll_period = 0.02 }
sweep = { coil = 0, status = 20, axis = 21, amplitude = 22 }
[geometry]
A_A = 0.0125
dp_nom = 35e5
[signals]
z = { dds = "{axis}/z", unit = "m" }
y_v = { modbus = { ring = 4, stride = 2 } }
p_A = { modbus = { register = 30, stride = 2, type = "int16", order = "CDAB" }, unit = "bar" }
)";

std::string Changed(const std::string& from, const std::string& to) {
  std::string text = kLive;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string Refusal(const std::string& text) {
  const auto machine = ParseMachine(text, "live.toml");
  if (machine) return "accepted";
  EXPECT_EQ(machine.error().kind, ErrorKind::kBadInput);
  return machine.error().text;
}

Machine Loaded(const std::string& text) {
  const auto machine = ParseMachine(text, "live.toml");
  if (!machine) ADD_FAILURE() << machine.error().text;
  return machine.value_or(Machine{});
}

TEST(LiveSpec, SaysWhereEverySignalOfEveryAxisComesFrom) {
  const Machine press = Loaded(kLive);
  EXPECT_EQ(AxisCount(press), 2);
  EXPECT_EQ(AxisMachineName(press, 1), "live/right");
  EXPECT_EQ(DdsChannelName(press, press.SignalIndex("z"), 1), "right/z");
  EXPECT_EQ(press.Source<DdsSpec>()->domain, 7);
  const ModbusOrigin& pressure = *press.signals[2].From<ModbusOrigin>();
  EXPECT_EQ(pressure.address, 30);
  EXPECT_EQ(pressure.type, RegisterType::kInt16);
  EXPECT_EQ(pressure.order, WordOrder::kCdab);
  EXPECT_TRUE(press.signals[1].From<ModbusOrigin>()->in_ring);
}

TEST(LiveSpec, ChannelsAreCountedAxisByAxis) {
  const Machine press = Loaded(kLive);
  const std::vector<LiveChannel> channels = LiveChannels(press);
  ASSERT_EQ(channels.size(), 6u);
  EXPECT_EQ(channels[1 * 3 + 2].name, "right/p_A");
  EXPECT_EQ(channels[1 * 3 + 2].axis, 1);
  EXPECT_EQ(channels[1 * 3 + 2].signal, 2);
}

TEST(LiveSpec, AMachineWithoutNamedAxesIsItsOnlyAxis) {
  const Machine press = Loaded(Changed("axes = [\"left\", \"right\"]", "axes = []"));
  EXPECT_EQ(AxisCount(press), 1);
  EXPECT_EQ(AxisMachineName(press, 0), "live");
  EXPECT_EQ(LiveChannels(press)[0].name, "z");
}

TEST(LiveSpec, ReadsBackEqualAfterWriting) {
  const Machine press = Loaded(kLive);
  const auto again = ParseMachine(FormatMachine(press), "written");
  ASSERT_TRUE(again) << again.error().text << "\n" << FormatMachine(press);
  EXPECT_EQ(press, *again) << FormatMachine(press);
}

TEST(LiveSpec, AFileWithoutLiveHasNone) {
  EXPECT_FALSE(
      Loaded("[signals]\np_A = \"a\"\nz = \"b\"\n[balance]\noutput = \"z\"\nterms = { a = \"p_A\" }\n").live);
}

TEST(LiveDamage, ASignalThatComesFromNowhereIsNamed) {
  EXPECT_THAT(
      Refusal(Changed("z = { dds = \"{axis}/z\", unit = \"m\" }", "z = { column = \"z\", unit = \"m\" }")),
      AllOf(HasSubstr("[signals.z]"), HasSubstr("neither dds nor modbus")));
}

TEST(LiveDamage, ASignalFromTwoPlacesIsRefused) {
  EXPECT_THAT(Refusal(Changed("z = {", "z = { modbus = { register = 3 },")), HasSubstr("one place"));
}

TEST(LiveDamage, AnOriginWithoutItsSectionIsNamed) {
  EXPECT_THAT(
      Refusal("[signals]\np_A = { dds = \"a\", unit = \"Pa\" }\nz = { column = \"z\", unit = \"m\" }\n"
              "y_v = \"y\"\n[geometry]\nA_A = 1\ndp_nom = 1e5\n"),
      HasSubstr("[live.dds]"));
}

TEST(LiveDamage, RegisterAndRingExcludeEachOther) {
  EXPECT_THAT(Refusal(Changed("ring = 4", "ring = 4, register = 4")),
              AllOf(StartsWith("live.toml:18:"), HasSubstr("either register")));
}

TEST(LiveDamage, AnAxisBeyondTheLastRegisterIsRefused) {
  EXPECT_THAT(Refusal(Changed("register = 30, stride = 2", "register = 30, stride = 65534")),
              HasSubstr("65535"));
}

TEST(LiveDamage, AValueBeyondTheRecordIsRefused) {
  EXPECT_THAT(Refusal(Changed("ring = 4, stride = 2", "ring = 7, stride = 2")),
              HasSubstr("place 10; the last one is 9"));
}

TEST(LiveDamage, ARingThatDoesNotFitTheRegistersIsRefused) {
  EXPECT_THAT(Refusal(Changed("records = 64", "records = 6000")), HasSubstr("65536"));
}

TEST(LiveDamage, ARingPolledTooSlowlyIsRefused) {
  EXPECT_THAT(Refusal(Changed("poll_period = 0.02", "poll_period = 0.05")), HasSubstr("samples are lost"));
}

TEST(LiveDamage, AnUnknownTypeIsSuggested) {
  EXPECT_THAT(Refusal(Changed("int16", "in16")), HasSubstr("did you mean \"int16\""));
}

TEST(LiveDamage, AnUnknownOrderIsRefused) {
  EXPECT_THAT(Refusal(Changed("CDAB", "CABD")), HasSubstr("\"CDAB\""));
}

TEST(LiveDamage, AxesAreNamedOnceAndPlainly) {
  EXPECT_THAT(Refusal(Changed("\"right\"", "\"left\"")), HasSubstr("only once"));
  EXPECT_THAT(Refusal(Changed("\"right\"", "\"a/b\"")), HasSubstr("names without /"));
}

TEST(LiveDamage, ASenderThatIsNoAddressIsRefused) {
  EXPECT_THAT(Refusal(Changed("10.0.0.0/8", "press")), AllOf(HasSubstr("senders"), HasSubstr("press")));
}

TEST(LiveDamage, APortOutsideItsRangeIsRefused) {
  EXPECT_THAT(Refusal(Changed("port = 1502", "port = 70000")),
              AllOf(StartsWith("live.toml:10:"), HasSubstr("a whole number from 1 to 65535")));
}

TEST(LiveDamage, AnIncompleteSweepIsRefused) {
  EXPECT_THAT(Refusal(Changed("status = 20, ", "")), HasSubstr("status is missing"));
}

}  // namespace
}  // namespace hydroscope
