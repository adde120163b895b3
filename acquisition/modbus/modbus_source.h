#pragma once

#include <cstdint>
#include <memory>

#include "acquisition/source.h"
#include "models/machine.h"

namespace hydroscope {

/// The polled registers of a live machine: one batch of one row per request, `period_ns` 0, sequence numbers
/// counted by the source. `seed` of the pauses between attempts to connect.
std::unique_ptr<Source> MakeModbusRegisterSource(const Machine& machine, Clock clock, std::uint64_t seed);

/// The burst ring of a live machine.
std::unique_ptr<Source> MakeModbusRingSource(const Machine& machine, Clock clock, std::uint64_t seed);

}  // namespace hydroscope
