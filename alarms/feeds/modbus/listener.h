#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "alarms/feeds/modbus/requests.h"
#include "core/clock.h"
#include "core/result.h"
#include "models/feeds_spec.h"

namespace hydroscope {

/// A Modbus TCP server on a thread of its own. No client can hold up another: sockets never block, a request
/// that is not complete 40 ms after its first byte ends its connection, so do a stream that is no Modbus and
/// a client that does not read its answers. libmodbus is no help here: its server reads and refuses with
/// waits inside.
class ModbusListener {
 public:
  /// Runs `answer` with the registers while nobody changes them.
  using WithRegisters = std::function<void(const std::function<void(const ModbusRegisters&)>& answer)>;

  /// Errors: the address is not ours, the port is taken or forbidden.
  static Result<std::unique_ptr<ModbusListener>> Open(const ModbusFeedSpec& spec, WithRegisters registers,
                                                      Clock clock);
  virtual ~ModbusListener() = default;

  virtual int port() const = 0;
  struct Counters {
    int clients = 0;
    std::int64_t accepted = 0;
    std::int64_t refused = 0;    ///< not allowed, or too many
    std::int64_t malformed = 0;  ///< connections ended because of what they sent, or left unread
  };
  virtual Counters counters() const = 0;
};

}  // namespace hydroscope
