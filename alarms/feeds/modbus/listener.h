#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "alarms/feeds/modbus/requests.h"
#include "alarms/feeds/modbus/settings.h"
#include "core/clock.h"
#include "core/result.h"
#include "models/ipv4_range.h"

namespace hydroscope {

/// A Modbus TCP server on a thread of its own. No client can hold up another: sockets never block, a request
/// that is not complete 40 ms after its first byte ends its connection, so do a stream that is no Modbus and
/// a client that does not read its answers. When there are as many as are allowed, one that never asked for anything gives way to
/// another one, else the one that has been idle longest. libmodbus is no help here: its server reads and refuses with waits inside.
class ModbusListener {
 public:
  /// Runs `answer` with the registers while nobody changes them. `client`: address of who asks.
  using WithRegisters = std::function<void(const std::string& client,
                                           const std::function<void(const ModbusRegisters&)>& answer)>;

  /// Errors: the address is not ours, the port is taken or forbidden.
  static Result<std::unique_ptr<ModbusListener>> Open(const ModbusFeedSpec& spec, WithRegisters registers,
                                                      Clock clock);
  virtual ~ModbusListener() = default;

  virtual int port() const = 0;
  struct Counters {
    int clients = 0;
    std::int64_t accepted = 0;
    std::int64_t refused = 0;    ///< not allowed, or too many
    std::int64_t gave_way = 0;   ///< idle ones ended for the sake of another client
    std::int64_t malformed = 0;  ///< connections ended because of what they sent, or left unread
    std::string refusal;         ///< the latest of `refused` and `malformed`: who, and why
  };
  virtual Counters counters() const = 0;
};

}  // namespace hydroscope
