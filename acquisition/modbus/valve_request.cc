#include "acquisition/modbus/valve_request.h"

#include <array>
#include <cmath>

namespace hydroscope {
namespace {

constexpr double kAmplitudeSteps = 1e4;  // of full scale

}  // namespace

bool IsFinal(SweepStatus status) { return status >= SweepStatus::kDone; }

ValveRequest::ValveRequest(const ModbusSpec& spec)
    : spec_(spec), link_(spec.host, spec.port, spec.unit, spec.timeout) {}

tl::unexpected<Error> ValveRequest::Failed(const char* what) {
  return BadInput("valve sweep: {}: {}", what, link_.problem().english);
}

Status ValveRequest::Connected() {
  if (!spec_.sweep)
    return BadInput("valve sweep: [live.modbus] has no sweep = {{ coil = ..., status = ... }}");
  if (link_.connected() || link_.Connect() == LinkOutcome::kDone) return {};
  return Failed("the controller is not reached");
}

Status ValveRequest::Ask(int axis, double amplitude) {
  if (!(amplitude > 0 && amplitude <= 1) || axis < 0)
    return UsageError(
        "valve sweep of axis {} with amplitude {}: expected a share of full scale above 0, up to 1", axis + 1,
        amplitude);
  TRY(Connected());
  const auto steps = static_cast<std::uint16_t>(std::lround(amplitude * kAmplitudeSteps));
  if (link_.WriteRegister(spec_.sweep->axis, static_cast<std::uint16_t>(axis + 1)) != LinkOutcome::kDone ||
      link_.WriteRegister(spec_.sweep->amplitude, steps) != LinkOutcome::kDone ||
      link_.WriteCoil(spec_.sweep->coil, true) != LinkOutcome::kDone)
    return Failed("the controller did not take the request");
  return {};
}

Result<SweepStatus> ValveRequest::Poll() {
  TRY(Connected());
  std::array<std::uint16_t, 1> word{};
  if (link_.Read(spec_.sweep->status, word) != LinkOutcome::kDone) return Failed("its status is not told");
  if (word[0] > static_cast<std::uint16_t>(SweepStatus::kBroken))
    return BadInput("valve sweep: the status register shows {}; expected 0 to {}", word[0],
                    static_cast<int>(SweepStatus::kBroken));
  return static_cast<SweepStatus>(word[0]);
}

}  // namespace hydroscope
