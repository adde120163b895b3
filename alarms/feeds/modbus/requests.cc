#include "alarms/feeds/modbus/requests.h"

#include <algorithm>

namespace hydroscope {
namespace {

constexpr std::size_t kHeader = 7;       // bytes, the unit identifier being the last
constexpr std::size_t kCountedFrom = 6;  // the length field counts the bytes behind it
constexpr int kMostRead = 125;           // registers in one answer

enum Function : std::uint8_t {
  kReadHolding = 3,
  kReadInput = 4,
  kWriteOne = 6,
  kWriteSeveral = 16,
};

int Word(std::span<const std::uint8_t> bytes, std::size_t at) { return bytes[at] << 8 | bytes[at + 1]; }

void AddWord(std::vector<std::uint8_t>& bytes, int word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word));
}

std::vector<std::uint8_t> Refuse(std::uint8_t function, ModbusException why) {
  return {static_cast<std::uint8_t>(function | 0x80), static_cast<std::uint8_t>(why)};
}

std::vector<std::uint8_t> Read(std::span<const std::uint8_t> request, const ModbusRegisters& registers) {
  if (request.size() != 5) return Refuse(request[0], ModbusException::kIllegalValue);
  const int first = Word(request, 1), count = Word(request, 3);
  if (count < 1 || count > kMostRead) return Refuse(request[0], ModbusException::kIllegalValue);
  if (static_cast<std::size_t>(first + count) > registers.registers.size())
    return Refuse(request[0], ModbusException::kIllegalAddress);
  std::vector<std::uint8_t> answer = {request[0], static_cast<std::uint8_t>(2 * count)};
  for (const std::uint16_t word :
       registers.registers.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)))
    AddWord(answer, word);
  return answer;
}

/// The answer to a write repeats its first five bytes.
std::vector<std::uint8_t> Write(std::span<const std::uint8_t> request, std::size_t value,
                                const ModbusRegisters& registers) {
  const auto refused = registers.write(Word(request, 1), static_cast<std::uint16_t>(Word(request, value)));
  if (refused) return Refuse(request[0], *refused);
  return {request.begin(), request.begin() + 5};
}

std::vector<std::uint8_t> WriteSeveral(std::span<const std::uint8_t> request,
                                       const ModbusRegisters& registers) {
  if (request.size() < 8 || Word(request, 3) < 1 || request[5] != 2 * Word(request, 3) ||
      request.size() != std::size_t{6} + request[5])
    return Refuse(request[0], ModbusException::kIllegalValue);
  // There is one register to write, so that a longer request touches one that is not.
  if (Word(request, 3) != 1) return Refuse(request[0], ModbusException::kIllegalAddress);
  return Write(request, 6, registers);
}

}  // namespace

std::vector<std::uint8_t> AnswerModbus(std::span<const std::uint8_t> request,
                                       const ModbusRegisters& registers) {
  switch (request[0]) {
    case kReadHolding:
    case kReadInput:
      return Read(request, registers);
    case kWriteOne:
      if (request.size() != 5) return Refuse(request[0], ModbusException::kIllegalValue);
      return Write(request, 3, registers);
    case kWriteSeveral:
      return WriteSeveral(request, registers);
    default:
      return Refuse(request[0], ModbusException::kIllegalFunction);
  }
}

bool ModbusConversation::Receive(std::span<const std::uint8_t> bytes, const ModbusRegisters& registers,
                                 std::vector<std::uint8_t>& answers) {
  for (;;) {
    const std::size_t wanted =
        size_ < kCountedFrom ? kHeader : kCountedFrom + static_cast<std::size_t>(Word(frame_, 4));
    if (size_ >= kCountedFrom && (Word(frame_, 2) != 0 || wanted <= kHeader || wanted > kLongestFrame))
      return false;
    if (size_ < wanted) {
      // The length stands in the header: it is read before what it counts.
      const std::size_t next = size_ < kCountedFrom ? kCountedFrom : wanted;
      const std::size_t taken = std::min(bytes.size(), next - size_);
      if (taken == 0) return true;
      std::copy_n(bytes.begin(), taken, frame_.begin() + size_);
      bytes = bytes.subspan(taken);
      size_ += taken;
      continue;
    }
    const auto answer = AnswerModbus(std::span(frame_).subspan(kHeader, wanted - kHeader), registers);
    answers.insert(answers.end(), frame_.begin(), frame_.begin() + 4);
    AddWord(answers, static_cast<int>(answer.size()) + 1);
    answers.push_back(frame_[kHeader - 1]);
    answers.insert(answers.end(), answer.begin(), answer.end());
    size_ = 0;
  }
}

}  // namespace hydroscope
