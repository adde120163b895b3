#include "pipeline/geometry_tolerance.h"

#include <fmt/format.h>

#include <cmath>

#include "models/machine_kind.h"

namespace hydroscope {

std::vector<AssumedTolerance> AssumeTolerances(Machine& machine) {
  std::vector<AssumedTolerance> assumed;
  for (const MachineInput& input : KindOf(machine).geometry) {
    const auto known = machine.geometry.find(std::string(input.name));
    if (input.shared_by.empty() || known == machine.geometry.end() || known->second.std > 0) continue;
    known->second.std = kAreaTolerance * std::abs(known->second.value);
    assumed.push_back({known->first, input.shared_by, known->second.std});
  }
  return assumed;
}

std::string AssumedText(const AssumedTolerance& assumed) {
  return fmt::format("{} has no tolerance in the machine file: {:g} % assumed, which {} share in proportion",
                     assumed.name, 100 * kAreaTolerance, assumed.shared_by);
}

}  // namespace hydroscope
