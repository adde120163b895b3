#include "alarms/feeds/modbus/requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

constexpr int kWritable = 100;

/// Registers 0 ... 199 that hold their own address, of which one may be written.
class Conversation {
 public:
  Conversation() : registers_(200) { std::iota(registers_.begin(), registers_.end(), std::uint16_t{0}); }

  Bytes Say(const Bytes& bytes) {
    Bytes answers;
    sound_ = conversation_.Receive(bytes,
                                   {registers_,
                                    [&](int address, std::uint16_t value) -> std::optional<ModbusException> {
                                      if (address != kWritable) return ModbusException::kIllegalAddress;
                                      written_.push_back(value);
                                      return std::nullopt;
                                    }},
                                   answers);
    return answers;
  }
  /// The answer to one request without its header.
  Bytes Ask(const Bytes& request) {
    Bytes frame = {1, 2, 0, 0, 0, static_cast<std::uint8_t>(request.size() + 1), 9};
    frame.insert(frame.end(), request.begin(), request.end());
    const Bytes answer = Say(frame);
    return answer.size() < 8 ? Bytes{} : Bytes(answer.begin() + 7, answer.end());
  }
  bool sound() const { return sound_; }
  bool halfway() const { return conversation_.halfway(); }
  const std::vector<std::uint16_t>& written() const { return written_; }

 private:
  std::vector<std::uint16_t> registers_, written_;
  ModbusConversation conversation_;
  bool sound_ = true;
};

TEST(ModbusRequests, AReadIsAnsweredWithTransactionAndUnitOfTheRequest) {
  EXPECT_THAT(Conversation().Say({0xab, 0xcd, 0, 0, 0, 6, 17, 3, 0, 7, 0, 2}),
              ElementsAre(0xab, 0xcd, 0, 0, 0, 7, 17, 3, 4, 0, 7, 0, 8));
}

TEST(ModbusRequests, BothReadFunctionsServeTheSameRegisters) {
  EXPECT_THAT(Conversation().Ask({4, 0, 199, 0, 1}), ElementsAre(4, 2, 0, 199));
}

TEST(ModbusRequests, AReadBeyondTheMapIsAnIllegalAddress) {
  EXPECT_THAT(Conversation().Ask({3, 0, 199, 0, 2}), ElementsAre(0x83, 2));
  EXPECT_THAT(Conversation().Ask({3, 0xff, 0xff, 0, 1}), ElementsAre(0x83, 2));
}

TEST(ModbusRequests, AReadOfNoneOrMoreThan125RegistersIsAnIllegalValue) {
  EXPECT_THAT(Conversation().Ask({3, 0, 0, 0, 0}), ElementsAre(0x83, 3));
  EXPECT_THAT(Conversation().Ask({3, 0, 0, 0, 126}), ElementsAre(0x83, 3));
  EXPECT_EQ(Conversation().Ask({3, 0, 0, 0, 125}).size(), 252u);
}

TEST(ModbusRequests, TheOneRegisterIsWrittenByFunctions6And16) {
  Conversation c;
  EXPECT_THAT(c.Ask({6, 0, kWritable, 0x12, 0x34}), ElementsAre(6, 0, kWritable, 0x12, 0x34));
  EXPECT_THAT(c.Ask({16, 0, kWritable, 0, 1, 2, 0x56, 0x78}), ElementsAre(16, 0, kWritable, 0, 1));
  EXPECT_THAT(c.written(), ElementsAre(0x1234, 0x5678));
}

TEST(ModbusRequests, AWriteElsewhereOrOfMoreIsAnIllegalAddress) {
  Conversation c;
  EXPECT_THAT(c.Ask({6, 0, 0, 0, 1}), ElementsAre(0x86, 2));
  EXPECT_THAT(c.Ask({16, 0, kWritable, 0, 2, 4, 0, 1, 0, 1}), ElementsAre(0x90, 2));
  EXPECT_THAT(c.written(), IsEmpty());
}

TEST(ModbusRequests, AWriteWhoseLengthsContradictIsAnIllegalValue) {
  Conversation c;
  EXPECT_THAT(c.Ask({6, 0, kWritable, 0}), ElementsAre(0x86, 3));
  EXPECT_THAT(c.Ask({16, 0, kWritable, 0, 1, 4, 0, 1}), ElementsAre(0x90, 3));
  EXPECT_THAT(c.Ask({16, 0, kWritable, 0, 1, 2, 0, 1, 0}), ElementsAre(0x90, 3));
  EXPECT_THAT(c.Ask({16, 0, kWritable}), ElementsAre(0x90, 3));
  EXPECT_THAT(c.Ask({16, 0, kWritable, 0, 0, 0, 0, 0}), ElementsAre(0x90, 3));
  EXPECT_THAT(c.written(), IsEmpty());
}

TEST(ModbusRequests, EveryOtherFunctionIsRefused) {
  for (int function = 0; function < 256; ++function) {
    if (function == 3 || function == 4 || function == 6 || function == 16) continue;
    EXPECT_THAT(Conversation().Ask({static_cast<std::uint8_t>(function), 0, kWritable, 0, 1}),
                ElementsAre(function | 0x80, 1));
  }
}

TEST(ModbusRequests, RequestsMayComeByteByByteOrSeveralAtOnce) {
  const Bytes request = {0, 1, 0, 0, 0, 6, 1, 3, 0, 5, 0, 1};
  Conversation bytewise;
  Bytes answer;
  for (const std::uint8_t byte : request) answer = bytewise.Say({byte});
  EXPECT_THAT(answer, ElementsAre(0, 1, 0, 0, 0, 5, 1, 3, 2, 0, 5));
  EXPECT_FALSE(bytewise.halfway());
  Conversation at_once;
  Bytes twice = request;
  twice.insert(twice.end(), request.begin(), request.end());
  twice.push_back(0);
  EXPECT_EQ(at_once.Say(twice).size(), 22u);
  EXPECT_TRUE(at_once.halfway());
}

TEST(ModbusRequests, AStreamThatIsNoModbusIsGivenUp) {
  for (const Bytes& bytes : {Bytes{0, 1, 0, 1, 0, 6}, Bytes{0, 1, 0, 0, 0, 0}, Bytes{0, 1, 0, 0, 0, 1},
                             Bytes{0, 1, 0, 0, 1, 0}, Bytes{'G', 'E', 'T', ' ', '/', ' '}}) {
    Conversation c;
    EXPECT_THAT(c.Say(bytes), IsEmpty());
    EXPECT_FALSE(c.sound());
  }
}

}  // namespace
}  // namespace hydroscope
