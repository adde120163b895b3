#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hydroscope {

/// A unit the machine file may name: SI value = value * scale + offset.
struct Unit {
  double scale = 1.0;
  double offset = 0.0;
  std::string_view
      si;  ///< SI unit of the same quantity: "Pa", "m", "s", "m3", "m3/s", "1", "K", "V", "N", ...
};

/// Looks up "bar", "mm", "l/min", "%", "degC", ...; nullopt if the unit is not known.
std::optional<Unit> FindUnit(std::string_view name);

/// All unit names, for messages that list what may be written.
std::vector<std::string> UnitNames();

/// The unit people read for an SI unit ("Pa" -> "bar", "m3/s" -> "l/min") and the factor from SI to it.
struct DisplayUnit {
  double factor = 1.0;
  double offset = 0.0;  ///< shown = si * factor + offset
  std::string_view name;
};
DisplayUnit DisplayUnitFor(std::string_view si);

/// The candidate nearest to `name` by edit distance, for "did you mean"; empty if none is near.
std::string Nearest(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace hydroscope
