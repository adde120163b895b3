#pragma once

#include <string>
#include <vector>

#include "core/told.h"
#include "models/machine_kind.h"
#include "setup/column_meaning.h"

namespace hydroscope {

/// How raw numbers become SI, with the reason.
struct UnitGuess {
  std::string unit;
  double scale = 1.0;
  double offset = 0.0;
  Told why;              ///< "unit in the header", "values up to 2.1e7 can only be Pa", ...
  bool sure = true;      ///< false: have a look
  Told to_fill_in = {};  ///< what only the user knows, and what to write; "" = nothing
};
/// Sizes that help with other columns' units.
struct SharedSizes {
  double largest_pressure = 0;  ///< largest raw reading of all pressure columns: they share one unit
  double spool_span = 0;        ///< how far the spool moves, 1 = from null to fully open; 0 = no spool
  bool current_loop = false;    ///< all pressures lie within 4 ... 20: mA of transmitters, not pressures
  double rows_per_cycle = 0;    ///< of the machine's strokes, by the pressure or the position; 0 = not seen
};
/// The unit that the column's name or header states, as the machine file writes it; "" if none.
std::string WrittenUnit(const LogColumn& column);

/// A unit taken as it is written in the column's header or name, or as a person chose it.
UnitGuess AsWritten(const std::string& unit, const LogColumn& column);

/// Whether what the column states as its unit can be that of a sensor in this role: of the role's own quantity, of a sensor's
/// signal (V, mA, %), or nothing. Revolutions per minute are no position, kW no pressure.
bool MayBe(Role role, const LogColumn& column);
/// The same of a signal of a kind of machine.
bool MayBe(const MachineInput& signal, const LogColumn& column);

/// Unit of a column in its role, from the header or by the size of its numbers.
UnitGuess GuessUnit(Role role, const LogColumn& column, const SharedSizes& sizes);

/// Unit of a column that is a signal of a kind of machine: from the header or name (1/min of a shaft counts revolutions); else
/// the one of the usual units in which its size is plausible for that signal. Sure where only one is.
UnitGuess GuessUnitOf(const MachineInput& signal, const LogColumn& column);

/// Whether the columns of a log without a meaning are those of 4 ... 20 mA transmitters: their names and headers say no unit (or
/// mA), and all of them that move lie where such a current does.
bool AreCurrentLoops(const LogColumns& head, const std::vector<std::size_t>& columns);
/// A current loop of an unknown sensor: its share of a range that only the plate on the sensor tells.
UnitGuess UnknownCurrentLoop(const LogColumn& column);

/// Sizes of the columns that have these roles.
SharedSizes FindSharedSizes(const LogColumns& head, const std::vector<ColumnRole>& roles);

}  // namespace hydroscope
