#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/result.h"

namespace hydroscope {

/// What is wrong with the wire, for tests of those who read it.
enum class ModbusFault {
  kNone,
  kHang,     ///< connections are taken, nothing is answered
  kGarbage,  ///< answers are random bytes
  kLate,     ///< answers come late
};

/// A Modbus TCP server with holding registers and coils on a thread of its own. An answer is an atomic
/// picture of the registers.
class ModbusServer {
 public:
  /// Called when a client writes 1 to a coil; the coil is cleared afterwards. On the server's thread,
  /// registers locked.
  using OnCoil = std::function<void(int coil, std::span<std::uint16_t> registers)>;

  using Change = std::function<void(std::span<std::uint16_t> registers)>;

  /// Listens on `host`:`port` with registers as `fill` leaves them; port 0 takes a free one. Errors: address
  /// not ours, port taken or forbidden.
  static Result<std::unique_ptr<ModbusServer>> Start(const std::string& host, int port, const Change& fill,
                                                     OnCoil on_coil);
  virtual ~ModbusServer() = default;

  virtual int port() const = 0;
  /// Changes registers between two answers.
  virtual void Update(const Change& change) = 0;
  /// `delay` in s, of late answers.
  virtual void SetFault(ModbusFault fault, double delay) = 0;
};

}  // namespace hydroscope
