#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "setup/column_meaning.h"

namespace hydroscope {
namespace {

TEST(ColumnNames, AreUnderstoodInEnglishAndGerman) {
  const std::vector<std::pair<std::string, Role>> names = {{"Time", Role::kTime},
                                                           {"Zeit [s]", Role::kTime},
                                                           {"timestamp", Role::kTime},
                                                           {"t_ms", Role::kTime},
                                                           {"pA", Role::kPressureA},
                                                           {"p_A [bar]", Role::kPressureA},
                                                           {"pressure_A", Role::kPressureA},
                                                           {"Druck A", Role::kPressureA},
                                                           {"Kolbendruck A", Role::kPressureA},
                                                           {"DruckKolbenseite", Role::kPressureA},
                                                           {"PressureB", Role::kPressureB},
                                                           {"Druck Stangenseite", Role::kPressureB},
                                                           {"Druck oben [bar]", Role::kPressureB},
                                                           {"Druck unten", Role::kPressureA},
                                                           {"pressure, upper chamber", Role::kPressureB},
                                                           {"Unterdruck", Role::kPressure},
                                                           {"Supply Pressure", Role::kSupplyPressure},
                                                           {"Pumpendruck", Role::kSupplyPressure},
                                                           {"Druck P [bar]", Role::kSupplyPressure},
                                                           {"Druck T", Role::kTankPressure},
                                                           {"Tankdruck", Role::kTankPressure},
                                                           {"Weg", Role::kPosition},
                                                           {"Position [mm]", Role::kPosition},
                                                           {"cushion position", Role::kPosition},
                                                           {"Ziehkissenhub", Role::kPosition},
                                                           {"Schieber", Role::kSpool},
                                                           {"spool position", Role::kSpool},
                                                           {"Ventilstellung", Role::kSpool},
                                                           {"valve command", Role::kValveCommand},
                                                           {"Ventilsollwert", Role::kValveCommand},
                                                           {"U_v", Role::kValveCommand},
                                                           {"Temperatur", Role::kOilTemperature},
                                                           {"oil temp", Role::kOilTemperature},
                                                           {"Position Soll", Role::kPositionCommand},
                                                           {"Kraft", Role::kForce},
                                                           {"Pressenweg", Role::kPosition},
                                                           {"Pressenkraft", Role::kForce}};
  for (const auto& [name, role] : names) EXPECT_EQ(RoleByName(name), role) << name;
  for (const char* name : {"", "CHANNEL0", "torque", "Druck Soll", "status", "Events"})
    EXPECT_FALSE(RoleByName(name)) << name;
}

}  // namespace
}  // namespace hydroscope
