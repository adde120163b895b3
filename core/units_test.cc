#include "core/units.h"

#include <gtest/gtest.h>

#include "core/effect_units.h"

namespace hydroscope {
namespace {

TEST(Units, EveryQuantityMayComePerSecondOrPerMinute) {
  struct Case {
    const char *name, *si;
    double scale;
  };
  for (const Case& c : {Case{"bar/s", "Pa/s", 1e5},
                        {"V/s", "V/s", 1},
                        {"K/min", "K/s", 1.0 / 60},
                        {"degC/min", "K/s", 1.0 / 60},
                        {"kN/s", "N/s", 1e3},
                        {"mm/s/s", "m/s2", 1e-3},
                        {"%/s", "1/s", 0.01},
                        {"kJ/s", "W", 1e3},
                        {"J/min", "W", 1.0 / 60},
                        {"mm/s2", "m/s2", 1e-3},
                        {"l/h", "m3/s", 1e-3 / 3600}}) {
    const auto unit = FindUnit(c.name);
    ASSERT_TRUE(unit) << c.name;
    EXPECT_EQ(unit->si, c.si) << c.name;
    EXPECT_DOUBLE_EQ(unit->scale, c.scale) << c.name;
    EXPECT_EQ(unit->offset, 0) << c.name;
  }
  EXPECT_EQ(FindUnit("m/s")->si, "m/s");
  EXPECT_FALSE(FindUnit("s/s"));
  EXPECT_FALSE(FindUnit("bars/s"));
}

TEST(Units, AreFoundAsPeopleTypeThem) {
  for (const auto& [typed, plain] : {std::pair("m/s²", "m/s2"),
                                     {"mm/s²", "mm/s2"},
                                     {"rad/s^2", "rad/s2"},
                                     {"cm³", "cm3"},
                                     {"N·m", "Nm"},
                                     {"µm", "um"},
                                     {"°", "deg"},
                                     {"°/s", "deg/s"},
                                     {"°C/min", "degC/min"}}) {
    const auto unit = FindUnit(typed), expected = FindUnit(plain);
    ASSERT_TRUE(unit && expected) << typed;
    EXPECT_EQ(unit->si, expected->si) << typed;
    EXPECT_EQ(unit->scale, expected->scale) << typed;
    EXPECT_EQ(unit->offset, expected->offset) << typed;
  }
  EXPECT_FALSE(FindUnit("1/V²"));
}

TEST(Units, SizesOfEffectsReadAsPressuresToo) {
  EXPECT_EQ(EffectUnitFor("Pa/m").name, "bar/m");
  EXPECT_DOUBLE_EQ(3e6 * EffectUnitFor("Pa/m").factor, 30);
}

TEST(Nearest, NamesNoWordThatHasNothingInCommon) {
  EXPECT_EQ(Nearest("KK", {"V_g", "c", "M_c"}), "");
  EXPECT_EQ(Nearest("Kk", {"V_g", "K", "M_c"}), "K");
  EXPECT_EQ(Nearest("foo", {"frf", "pump"}), "") << "a third of it";
  EXPECT_EQ(Nearest("replya", {"replay", "report"}), "replay");
  EXPECT_EQ(Nearest("fti", {"frf", "fit"}), "fit") << "two letters swapped are one mistake";
  EXPECT_EQ(Nearest("akc", {"list", "ack"}), "ack");
}

}  // namespace
}  // namespace hydroscope
