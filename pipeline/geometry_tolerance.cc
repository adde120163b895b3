#include "pipeline/geometry_tolerance.h"

#include <fmt/format.h>

#include <cmath>

namespace hydroscope {

std::vector<AssumedTolerance> AssumeTolerances(Machine& machine) {
  std::vector<AssumedTolerance> assumed;
  if (machine.model != "die_cushion") return assumed;
  const auto area = machine.geometry.find("A_A");
  if (area == machine.geometry.end() || area->second.std > 0) return assumed;
  area->second.std = kAreaTolerance * std::abs(area->second.value);
  assumed.push_back({area->first, area->second.std});
  return assumed;
}

std::string AssumedText(const AssumedTolerance& assumed) {
  return fmt::format(
      "{} has no tolerance in the machine file: {:g} % assumed, which V0 and Q_vn share in proportion",
      assumed.name, 100 * kAreaTolerance);
}

}  // namespace hydroscope
