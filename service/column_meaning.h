#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/log_head.h"

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

/// How raw numbers become SI, with the reason.
struct UnitGuess {
  std::string unit;
  double scale = 1.0;
  double offset = 0.0;
  std::string why;   ///< "unit in the header", "values up to 2.1e+07 can only be Pa", ...
  bool sure = true;  ///< false: have a look
};
/// Unit of a column in its role, from the header or by the size of its numbers. `largest_pressure` is the
/// largest reading of all pressure columns: they share one unit.
UnitGuess GuessUnit(Role role, const HeadColumn& column, double largest_pressure);

/// A column with its role.
struct ColumnRole {
  std::size_t column = 0;
  Role role = Role::kTime;
  std::string why;
  bool sure = true;
};
/// Roles of the columns: by name first, what is left by behaviour. No role is given twice.
std::vector<ColumnRole> AssignRoles(const LogHead& head);

}  // namespace hydroscope
