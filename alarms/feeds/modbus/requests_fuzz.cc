// libFuzzer target: whatever a client sends, in whatever pieces, only the acknowledge register is written,
// answers are sound frames, and cutting the bytes otherwise changes nothing.
#include <cstdlib>

#include "alarms/feeds/modbus/register_map.h"
#include "alarms/feeds/modbus/requests.h"

namespace {

using namespace hydroscope;

struct Heard {
  bool sound = true;
  std::vector<std::uint8_t> answers;
};

Heard Say(std::span<const std::uint8_t> bytes, std::size_t piece) {
  static const std::vector<std::uint16_t> registers(register_map::kRegisters, 7);
  ModbusConversation conversation;
  Heard heard;
  const ModbusRegisters map{registers, [](int address, std::uint16_t) -> std::optional<ModbusException> {
                              if (address != register_map::kAcknowledge)
                                return ModbusException::kIllegalAddress;
                              return std::nullopt;
                            }};
  while (!bytes.empty() && heard.sound) {
    const std::size_t now = std::min(piece, bytes.size());
    heard.sound = conversation.Receive(bytes.first(now), map, heard.answers);
    bytes = bytes.subspan(now);
  }
  return heard;
}

void CheckFrames(std::span<const std::uint8_t> answers) {
  while (!answers.empty()) {
    if (answers.size() < 9 || answers[2] != 0 || answers[3] != 0) std::abort();
    const std::size_t length = static_cast<std::size_t>(answers[4] << 8 | answers[5]) + 6;
    if (length < 9 || length > ModbusConversation::kLongestFrame || length > answers.size()) std::abort();
    answers = answers.subspan(length);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::span bytes(data + 1, size - 1);
  const Heard whole = Say(bytes, bytes.size() + 1), pieces = Say(bytes, 1u + data[0] % 16u);
  if (whole.sound != pieces.sound || whole.answers != pieces.answers) std::abort();
  CheckFrames(whole.answers);
  return 0;
}
