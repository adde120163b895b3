#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "models/machine.h"
#include "models/machine_file/table.h"

namespace hydroscope {
namespace {

/// A machine of one's own whose output is measured in `unit`.
Result<Machine> OwnMachineIn(const std::string& unit) {
  return ParseMachine(
      fmt::format("[machine]\nname = \"own\"\n[log]\ntime = {{ column = \"t\", unit = \"s\" }}\n"
                  "[signals]\nx = {{ column = \"x\", unit = \"m\" }}\n"
                  "y = {{ column = \"y\", unit = \"{0}\" }}\n"
                  "[balance]\noutput = \"y\"\nunit = \"{1}\"\nterms = {{ a = \"x\" }}\n",
                  unit, FindFileUnit(unit)->si),
      "own.toml");
}

TEST(MachineUnits, ThoseOfPowerTorqueAndRotationMayStandEverywhere) {
  for (const char* unit : {"W", "kW", "Nm", "N", "rpm", "rad", "deg", "rad/s", "m/s2", "1/min", "1/s", "kg",
                           "%/K", "1/K", "bar/s", "V/s", "K/min", "bar/min"}) {
    const auto machine = OwnMachineIn(unit);
    EXPECT_TRUE(machine) << unit << ": " << (machine ? "" : machine.error().text);
  }
}

TEST(MachineUnits, GatesOnRatesTakeUnitsOfTheRate) {
  const auto machine = ParseMachine(R"toml(
[machine]
name = "own"
[log]
time = { column = "t", unit = "s" }
[signals]
w = { column = "w", unit = "rpm" }
v = { column = "v", unit = "mm/s" }
[gate]
conditions = { "ddt(w)" = { max = 1, unit = "rad/s2" }, "ddt(v)" = { min = 2, unit = "mm/s2" } }
[balance]
output = "v"
unit = "m/s"
terms = { a = "w" }
)toml",
                                    "own.toml");
  ASSERT_TRUE(machine) << machine.error().text;
  ASSERT_EQ(machine->gate.bounds.size(), 2u);
  for (const GateBound& bound : machine->gate.bounds)
    EXPECT_DOUBLE_EQ(bound.min.value_or(*bound.max), bound.signal == "v" ? 2e-3 : 1.0);
}

TEST(MachineUnits, HaveTheirSizeInSi) {
  EXPECT_DOUBLE_EQ(FindFileUnit("rpm")->scale, 2 * std::numbers::pi / 60);
  EXPECT_DOUBLE_EQ(FindFileUnit("deg")->scale, std::numbers::pi / 180);
  EXPECT_DOUBLE_EQ(FindFileUnit("K/min")->scale, 1.0 / 60);
  EXPECT_EQ(FindFileUnit("K/min")->si, "K/s");
  EXPECT_DOUBLE_EQ(FindFileUnit("kW")->scale, 1e3);
  EXPECT_FALSE(FindFileUnit("furlong/min"));
}

}  // namespace
}  // namespace hydroscope
