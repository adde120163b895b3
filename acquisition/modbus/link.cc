#include "acquisition/modbus/link.h"

#include <fmt/format.h>
#include <modbus/modbus.h>
#include <netdb.h>

#include <cerrno>
#include <cmath>

namespace hydroscope {

struct ModbusLink::Context {
  explicit Context(modbus_t* m) : modbus(m) {}
  ~Context() { modbus_free(modbus); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  modbus_t* modbus;
};

ModbusLink::ModbusLink(std::string host, int port, int unit, double timeout)
    : host_(std::move(host)), port_(port), unit_(unit), timeout_(timeout) {}

ModbusLink::~ModbusLink() { Close(); }

void ModbusLink::Close() {
  if (connected_) modbus_close(context_->modbus);
  connected_ = false;
  context_.reset();
}

Told ModbusLink::WhyNotConnected(int error) const {
  if (error == EINPROGRESS)
    return {"no answer", "keine Antwort"};  // what a host that does not answer at all leaves behind
  if (error != ECONNREFUSED) return {modbus_strerror(error)};
  // libmodbus says so of a name that nobody knows, too.
  addrinfo* found = nullptr;
  const int unknown = getaddrinfo(host_.c_str(), nullptr, nullptr, &found);
  if (found != nullptr) freeaddrinfo(found);
  return unknown != 0
             ? Told("nobody knows a computer of this name", "niemand kennt einen Rechner dieses Namens")
             : Told(modbus_strerror(error), "die Verbindung wird abgelehnt");
}

Told ModbusLink::NoConnection(const Told& why) const {
  return Tell("no connection to {}:{}: {}", "keine Verbindung zu {}:{}: {}", host_, port_, why);
}

LinkOutcome ModbusLink::Connect() {
  Close();
  modbus_t* modbus = modbus_new_tcp_pi(host_.c_str(), std::to_string(port_).c_str());
  if (modbus == nullptr) {
    problem_ = NoConnection({modbus_strerror(errno)});
    return LinkOutcome::kBroken;
  }
  context_ = std::make_unique<Context>(modbus);
  const auto seconds = static_cast<std::uint32_t>(timeout_);
  const auto microseconds = static_cast<std::uint32_t>((timeout_ - std::floor(timeout_)) * 1e6);
  modbus_set_response_timeout(modbus, seconds, microseconds);
  modbus_set_error_recovery(modbus, MODBUS_ERROR_RECOVERY_NONE);
  modbus_set_slave(modbus, unit_);
  if (modbus_connect(modbus) != 0) {
    problem_ = NoConnection(WhyNotConnected(errno));
    context_.reset();
    return LinkOutcome::kBroken;
  }
  connected_ = true;
  return LinkOutcome::kDone;
}

LinkOutcome ModbusLink::Judge(int result, const std::string& request) {
  if (result >= 0) return LinkOutcome::kDone;
  const int error = errno;
  problem_ = {fmt::format("{}: {}", request, modbus_strerror(error))};
  if (error > MODBUS_ENOBASE && error <= EMBXGTAR) return LinkOutcome::kException;
  // After anything else the stream may hold half or late answers: only a new connection is clean.
  Close();
  if (error == ETIMEDOUT) return LinkOutcome::kTimeout;
  return error > MODBUS_ENOBASE ? LinkOutcome::kGarbage : LinkOutcome::kBroken;
}

LinkOutcome ModbusLink::Read(int first, std::span<std::uint16_t> registers) {
  if (!connected_) return LinkOutcome::kBroken;
  const auto count = static_cast<int>(registers.size());
  const int got = modbus_read_registers(context_->modbus, first, count, registers.data());
  return Judge(got, fmt::format("registers {} to {}", first, first + count - 1));
}

LinkOutcome ModbusLink::WriteRegister(int address, std::uint16_t value) {
  if (!connected_) return LinkOutcome::kBroken;
  return Judge(modbus_write_register(context_->modbus, address, value),
               fmt::format("writing register {}", address));
}

LinkOutcome ModbusLink::WriteCoil(int address, bool value) {
  if (!connected_) return LinkOutcome::kBroken;
  return Judge(modbus_write_bit(context_->modbus, address, value), fmt::format("writing coil {}", address));
}

}  // namespace hydroscope
