#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "acquisition/source.h"
#include "models/machine.h"

namespace hydroscope {

/// Every source that the machine file asks for: DDS, registers, ring; in this order, as far as signals come
/// from there.
std::vector<std::unique_ptr<Source>> MakeSources(const Machine& machine, const Clock& clock,
                                                 std::uint64_t seed);

}  // namespace hydroscope
