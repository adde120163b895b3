#include "models/doubled_signals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Machine Read(const std::string& signals) {
  const auto machine = ParseMachine(R"toml(
[machine]
name = "press"
model = "die_cushion"
[live]
axes = ["left", "right"]
[live.modbus]
[live.dds]
[geometry]
A_A = 0.0125
dp_nom = 35e5
p_t = 0
[signals]
)toml" + signals,
                                    "press.toml");
  EXPECT_TRUE(machine) << (machine ? "" : machine.error().text);
  return machine.value_or(Machine());
}

TEST(DoubledSignals, AreThoseOfOneColumn) {
  const auto doubled = DoubledSignalsOf(Read(R"toml(
p_A = { column = "p", unit = "bar", dds = "{axis}/p_A" }
z = { column = "z", unit = "m", dds = "{axis}/z" }
y_v = { column = "y", unit = "1", dds = "{axis}/y" }
p_B = { column = "p", unit = "bar", required = false }
)toml"));
  ASSERT_THAT(doubled, SizeIs(1));
  EXPECT_FALSE(doubled[0].live);
  EXPECT_THAT(doubled[0].text.english, HasSubstr("p_A and p_B both read column 'p'"));
}

TEST(DoubledSignals, AreThoseOfOneChannelOrRegisterAtAnyAxis) {
  const auto channels = DoubledSignalsOf(Read(R"toml(
p_A = { unit = "bar", dds = "{axis}/p" }
p_B = { unit = "bar", dds = "{axis}/p", required = false }
z = { unit = "m", dds = "{axis}/z" }
y_v = { unit = "1", dds = "{axis}/y" }
)toml"));
  ASSERT_THAT(channels, SizeIs(1));
  EXPECT_TRUE(channels[0].live);
  const auto registers = DoubledSignalsOf(Read(R"toml(
p_A = { unit = "bar", modbus = { register = 100, stride = 10 } }
p_B = { unit = "bar", modbus = { register = 111, stride = 10, type = "uint16" }, required = false }
z = { unit = "m", modbus = { register = 102, stride = 10 } }
y_v = { unit = "1", modbus = { register = 104, stride = 10 } }
)toml"));
  ASSERT_THAT(registers, SizeIs(1)) << "the second half of p_A of the second axis";
  EXPECT_THAT(registers[0].text.english, HasSubstr("p_A and p_B come from one place"));
}

TEST(DoubledSignals, AreNoneOfNeighbours) {
  EXPECT_THAT(DoubledSignalsOf(Read(R"toml(
p_A = { unit = "bar", modbus = { register = 100, stride = 10 } }
z = { unit = "m", modbus = { register = 102, stride = 10 } }
y_v = { unit = "1", modbus = { register = 104, stride = 10 } }
T_oil = { unit = "degC", modbus = { register = 90 }, required = false }
)toml")),
              IsEmpty());
}

}  // namespace
}  // namespace hydroscope
