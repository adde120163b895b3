#include "acquisition/live_sources.h"

#include <algorithm>

#include "acquisition/dds/dds_source.h"
#include "acquisition/modbus/modbus_source.h"

namespace hydroscope {
namespace {

bool AnySignal(const Machine& machine, const auto& condition) {
  return std::any_of(machine.signals.begin(), machine.signals.end(), condition);
}

}  // namespace

std::vector<std::unique_ptr<Source>> MakeSources(const Machine& machine, const Clock& clock,
                                                 std::uint64_t seed) {
  std::vector<std::unique_ptr<Source>> sources;
  if (AnySignal(machine, [](const SignalSpec& s) { return !s.dds.empty(); }))
    sources.push_back(MakeDdsSource(DdsOptionsFor(machine), clock));
  if (AnySignal(machine, [](const SignalSpec& s) { return s.modbus && !s.modbus->in_ring; }))
    sources.push_back(MakeModbusRegisterSource(machine, clock, seed));
  if (AnySignal(machine, [](const SignalSpec& s) { return s.modbus && s.modbus->in_ring; }))
    sources.push_back(MakeModbusRingSource(machine, clock, seed + 1));
  return sources;
}

}  // namespace hydroscope
