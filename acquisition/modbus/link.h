#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/told.h"

namespace hydroscope {

/// What became of a request.
enum class LinkOutcome {
  kDone,
  kException,  ///< the controller refuses this request; the connection is sound
  kTimeout,    ///< no answer in time; the connection was closed, because the answer may still come
  kGarbage,    ///< an answer that is none; the connection was closed
  kBroken,     ///< refused, reset or not connected; the connection is closed
};

/// One Modbus TCP connection. Never waits longer than the timeout and never reconnects by itself.
class ModbusLink {
 public:
  /// `timeout` in s, for connecting and for every answer.
  ModbusLink(std::string host, int port, int unit, double timeout);
  ~ModbusLink();

  LinkOutcome Connect();
  void Close();
  bool connected() const { return connected_; }

  /// Reads registers.size() (1 to 125) holding registers from `first` on.
  LinkOutcome Read(int first, std::span<std::uint16_t> registers);
  LinkOutcome WriteRegister(int address, std::uint16_t value);
  LinkOutcome WriteCoil(int address, bool value);

  /// What the last request that was not done met, for people.
  const Told& problem() const { return problem_; }

 private:
  struct Context;
  LinkOutcome Judge(int result, const std::string& request);
  /// Of a connection that failed with this errno.
  Told WhyNotConnected(int error) const;
  Told NoConnection(const Told& why) const;

  std::string host_;
  int port_, unit_;
  double timeout_;
  std::unique_ptr<Context> context_;
  bool connected_ = false;
  Told problem_;
};

}  // namespace hydroscope
