#pragma once

#include <cstdint>

#include "acquisition/modbus/link.h"
#include "acquisition/modbus/settings.h"
#include "core/result.h"

namespace hydroscope {

/// What the controller says to the request for a valve sweep; the numbers of the status register.
enum class SweepStatus : std::uint16_t {
  kUndecided = 0,  ///< nothing asked for, or not yet decided
  kGranted = 1,    ///< will begin
  kRunning = 2,
  kDone = 3,
  kBusy = 4,     ///< refused: the machine is not at rest, or a sweep is running
  kRefused = 5,  ///< refused: not this axis or amplitude, or not allowed at all
  kBroken = 6,   ///< begun and broken off by the controller
};
/// The sweep has come to an end, whichever.
bool IsFinal(SweepStatus status);

/// Asks a controller for a valve sweep and follows what becomes of it. The controller alone decides; nothing
/// is moved otherwise. A connection of its own; every call takes at most a few timeouts of the machine file.
class ValveRequest {
 public:
  /// `spec.sweep` must be set.
  explicit ValveRequest(const ModbusSpec& spec);

  /// Asks for a sweep of `axis` (from 0) with `amplitude`, a share of full scale. Success means asked, not granted:
  /// look at Poll until it is decided. Errors: no [live.modbus] sweep, amplitude outside 0 ... 1, no connection.
  Status Ask(int axis, double amplitude);
  /// Errors: no connection, or a status the protocol does not know. The next call connects again.
  Result<SweepStatus> Poll();

 private:
  Status Connected();
  tl::unexpected<Error> Failed(const char* what);

  ModbusSpec spec_;
  ModbusLink link_;
};

}  // namespace hydroscope
