#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/machine_kind.h"
#include "models/model_structure.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

/// An axis that drives two loads, with these lines in [conditions].
std::string AxisFile(const std::string& conditions) {
  return R"toml(
[machine]
name = "axis"
[signals]
F = { column = "F", unit = "N" }
x = { column = "x", unit = "mm" }
T_oil = { column = "T", unit = "degC" }
m = { column = "m", unit = "kg", required = false }
[balance]
output = "F"
unit = "N"
terms = { d = "ddt(x)", c = "1" }
[conditions]
)toml" + conditions;
}

TEST(ConditionsSection, SaysWhatIsTakenOfWhichSignal) {
  const auto machine =
      ParseMachine(AxisFile("load = \"m\"\nspeed = \"abs(ddt(x))\"\npeak = \"max(F)\"\n"), "axis.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  ASSERT_EQ(machine->conditions.size(), 3u);
  EXPECT_EQ(machine->conditions[0].name, "load");
  EXPECT_EQ(machine->conditions[0].of, Condition::Of::kMean);
  EXPECT_EQ(machine->conditions[0].unit, "kg");
  EXPECT_EQ(machine->conditions[1].signal, "x");
  EXPECT_EQ(machine->conditions[1].of, Condition::Of::kMeanRate);
  EXPECT_EQ(machine->conditions[1].unit, "m/s");
  EXPECT_EQ(machine->conditions[2].of, Condition::Of::kLargest);
  const auto again = ParseMachine(FormatMachine(*machine), "again.toml");
  ASSERT_TRUE(again) << again.error().text;
  EXPECT_EQ(*again, *machine);
}

TEST(ConditionsSection, ItsSignalsAndTheTemperatureAreChannelsThoughNoExpressionReadsThem) {
  const auto machine = ParseMachine(AxisFile("load = \"m\"\n"), "axis.toml");
  const auto model = BuildModel(machine.value());
  ASSERT_TRUE(model) << model.error().text;
  EXPECT_GE((*model)->MeasuredChannel("m"), 0);
  EXPECT_GE((*model)->temperature_channel, 0);
  ASSERT_EQ((*model)->conditions.size(), 1u);
  EXPECT_EQ((*model)->ConditionNames().front().name, "load");
}

TEST(ConditionsSection, WhatIsNoSignalPointsAtTheLineAndWhatIsTooManySaysTheLimit) {
  const auto unknown = ParseMachine(AxisFile("load = \"mass\"\n"), "axis.toml");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().text, HasSubstr("axis.toml:14"));
  EXPECT_THAT(unknown.error().text, HasSubstr("\"mass\": expected a signal"));
  std::string many;
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) many += std::string(name) + " = \"m\"\n";
  const auto seven = ParseMachine(AxisFile(many), "axis.toml");
  ASSERT_FALSE(seven);
  EXPECT_THAT(seven.error().text, HasSubstr("at most 6"));
}

TEST(ConditionsSection, ADieCushionKeepsItsOwnBesideThem) {
  const std::string file = R"(
[machine]
name = "press"
[signals]
p_A = { column = "p", unit = "bar" }
z = { column = "z", unit = "mm" }
y_v = { column = "y" }
[geometry]
A_A = { value = 125, unit = "cm2" }
dp_nom = { value = 35, unit = "bar" }
[conditions]
)";
  const auto more = ParseMachine(file + "stroke_end = \"max(z)\"\n", "press.toml");
  ASSERT_TRUE(more) << more.error().text;
  const auto conditions = ConditionsOf(*more);
  ASSERT_EQ(conditions.size(), 4u);
  EXPECT_EQ(conditions[0].name, "speed");
  EXPECT_EQ(conditions[3].name, "stroke_end");
  const auto twice = ParseMachine(file + "speed = \"z\"\n", "press.toml");
  ASSERT_FALSE(twice);
  EXPECT_THAT(twice.error().text, HasSubstr("speed is a condition of every such machine"));
}

}  // namespace
}  // namespace hydroscope
