#pragma once

#include <optional>
#include <string>
#include <vector>

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

/// Unit at the end of a column's name, as the machine file writes it: "bar" of "pA_bar", "mm" of "s_mm", "ms" of "t_ms";
/// "" if there is none. Single letters only where the rest of the name says what they are: "y_v" is no volt.
std::string UnitInName(const std::string& name);

/// How raw numbers become SI, with the reason.
struct UnitGuess {
  std::string unit;
  double scale = 1.0;
  double offset = 0.0;
  std::string why;   ///< "unit in the header", "values up to 2.1e+07 can only be Pa", ...
  bool sure = true;  ///< false: have a look
};
/// Sizes that help with other columns' units.
struct SharedSizes {
  double largest_pressure = 0;  ///< largest raw reading of all pressure columns: they share one unit
  double spool_span = 0;        ///< how far the spool moves, 1 = from null to fully open; 0 = no spool
  bool current_loop = false;    ///< all pressures lie within 4 ... 20: mA of transmitters, not pressures
  double rows_per_cycle = 0;    ///< of the machine's strokes, by the pressure or the position; 0 = not seen
};
/// Unit of a column in its role, from the header or by the size of its numbers.
UnitGuess GuessUnit(Role role, const LogColumn& column, const SharedSizes& sizes);

/// A column with its role.
struct ColumnRole {
  std::size_t column = 0;
  Role role = Role::kTime;
  std::string why;
  bool sure = true;
};
/// Roles of the columns: by name first, what is left by behaviour. No role is given twice.
std::vector<ColumnRole> AssignRoles(const LogColumns& head);
/// Sizes of the columns that have these roles.
SharedSizes FindSharedSizes(const LogColumns& head, const std::vector<ColumnRole>& roles);

}  // namespace hydroscope
