#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace hydroscope {

/// Exception codes of the Modbus application protocol, V1.1b3, chapter 7.
enum class ModbusException : std::uint8_t {
  kIllegalFunction = 1,
  kIllegalAddress = 2,
  kIllegalValue = 3,
  kDeviceFailure = 4,
  kDeviceBusy = 6,
};

/// What a request may touch.
struct ModbusRegisters {
  std::span<const std::uint16_t> registers;  ///< from 0
  /// Takes what is written to one register, or refuses it.
  std::function<std::optional<ModbusException>(int address, std::uint16_t value)> write;
};

/// Cuts the bytes of one connection into requests (Modbus Messaging on TCP/IP V1.0b, MBAP header: transaction
/// 2, protocol 2 = 0, length 2, unit 1) and answers them. Pure: bytes in, bytes out. Functions 3 and 4 (read
/// registers), 6 and 16 (write one register) are served; every other one is refused.
class ModbusConversation {
 public:
  static constexpr std::size_t kLongestFrame = 260;

  /// Takes bytes as they arrived, appends the answers to all requests that are complete. False: no request
  /// can begin like this, so that the rest of the stream cannot be read either; close the connection.
  bool Receive(std::span<const std::uint8_t> bytes, const ModbusRegisters& registers,
               std::vector<std::uint8_t>& answers);
  /// A request has begun and is not complete.
  bool halfway() const { return size_ > 0; }

 private:
  std::array<std::uint8_t, kLongestFrame> frame_{};
  std::size_t size_ = 0;
};

/// Answer to one request without header: function code and data; `request` is not empty.
std::vector<std::uint8_t> AnswerModbus(std::span<const std::uint8_t> request,
                                       const ModbusRegisters& registers);

}  // namespace hydroscope
