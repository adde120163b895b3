#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/told.h"
#include "setup/log_columns.h"

namespace hydroscope {

/// What a column of a log may be.
enum class Role {
  kTime,
  kPressureA,
  kPressureB,
  kSupplyPressure,
  kTankPressure,
  kPressure,
  kPosition,
  kPositionCommand,
  kSpool,
  kValveCommand,
  kOilTemperature,
  kForce
};
/// Name of the signal in a machine file: "p_A", "z", ...; "t" for time.
const char* SignalNameOf(Role role);

/// Role by the column's name: usual English and German names, with or without unit in brackets; nullopt if
/// the name says nothing.
std::optional<Role> RoleByName(const std::string& name);

/// Whether the name tells the chamber of a pressure by above or below alone, and so the rod's side by how cylinders of presses
/// are mostly built in.
bool TellsAboveOrBelow(const std::string& name);

/// A name by its letters and digits alone, small, umlauts written out, without a unit in brackets or at its end: "npump" of
/// "n_pump [rpm]".
std::string BareName(const std::string& name);

/// Unit at the end of a column's name, as the machine file writes it: "bar" of "pA_bar", "mm" of "s_mm", "ms" of "t_ms";
/// "" if there is none. Single letters only where the rest of the name says what they are: "y_v" is no volt.
std::string UnitInName(const std::string& name);
/// "jack pressure" of "jack pressure [bar]", "Drehzahl" of "Drehzahl_1/min".
std::string NameWithoutUnit(const std::string& name);
/// "Oel" of "Öl".
std::string WithoutUmlauts(std::string text);

/// A column with its role.
struct ColumnRole {
  std::size_t column = 0;
  Role role = Role::kTime;
  Told why;
  bool sure = true;
};
/// Roles of the columns: by name first, what is left by behaviour. No role is given twice.
std::vector<ColumnRole> AssignRoles(const LogColumns& head);

}  // namespace hydroscope
