// The Modbus client against a controller that is ill, and the request for a valve sweep.
#include "acquisition/modbus/modbus_source.h"

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "acquisition/modbus/retry.h"
#include "acquisition/modbus/valve_request.h"
#include "tests/live_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

class IllController : public ::testing::Test {
 protected:
  IllController() {
    press_.Live(std::nullopt, 10);
    const auto machine = ParseMachine(
        fmt::format(
            "[live]\naxes = [\"left\", \"right\"]\n[live.modbus]\nport = {}\npoll_period = 0.02\ntimeout = 0.1\n"
            "retry_first = 0.05\nretry_limit = 0.1\nheartbeat = 15\nsweep = {{ coil = 0, status = 20, axis = "
            "21, amplitude = 22 }}\n[signals]\nx = {{ modbus = {{ register = 32 }} }}\n"
            "[balance]\noutput = \"x\"\nterms = {{ k = \"1\" }}\n",
            press_.port()),
        "press.toml");
    EXPECT_TRUE(machine) << machine.error().text;
    machine_ = *machine;
    source_ = MakeModbusRegisterSource(machine_, RealTime, 1);
    EXPECT_TRUE(source_->Start(sink_.sink()));
    EXPECT_TRUE(sink_.WaitForMore(2));
  }
  ~IllController() override { source_->Stop(); }

  void Fault(ModbusFault fault, double delay = 0) {
    ASSERT_TRUE(press_.server().Do(ModbusFaultCommand{fault, delay}));
  }
  bool IsGone() {
    return WaitUntil([&] { return !source_->status().connected; }, 3);
  }
  /// s from now until readings come again.
  double Recovery() {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_TRUE(sink_.WaitForMore(1)) << source_->status().state.english;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  TestPress press_;
  TestSink sink_;
  Machine machine_;
  std::unique_ptr<Source> source_;
};

TEST_F(IllController, ThatHangsIsLeftAndFoundAgain) {
  Fault(ModbusFault::kHang);
  EXPECT_TRUE(IsGone());
  EXPECT_TRUE(WaitUntil([&] { return source_->status().timeouts >= 2; }));
  EXPECT_THAT(source_->status().state.english, HasSubstr("timed out"));
  Fault(ModbusFault::kNone);
  EXPECT_LT(Recovery(), 0.5) << "two pauses of 0.1 s and a timeout";
}

TEST_F(IllController, ThatAnswersGarbageGivesNoReading) {
  Fault(ModbusFault::kGarbage);
  EXPECT_TRUE(WaitUntil([&] { return source_->status().malformed + source_->status().timeouts >= 2; }));
  const std::int64_t rows = sink_.rows();
  EXPECT_TRUE(WaitUntil([&] { return source_->status().malformed + source_->status().timeouts >= 5; }));
  EXPECT_EQ(sink_.rows(), rows);
  Fault(ModbusFault::kNone);
  EXPECT_LT(Recovery(), 0.5);
}

TEST_F(IllController, ThatAnswersTooLateNeverGivesAnAnswerToAnotherRequest) {
  Fault(ModbusFault::kLate, 0.15);
  EXPECT_TRUE(WaitUntil([&] { return source_->status().timeouts >= 3; }));
  Fault(ModbusFault::kNone);
  EXPECT_LT(Recovery(), 1.0);
  EXPECT_EQ(source_->status().malformed, 0) << "late answers die with their connection";
}

TEST_F(IllController, ThatFreezesIsToldByItsHeartbeatAndItsOldValuesAreNotDelivered) {
  ASSERT_TRUE(press_.server().Do(FreezeCommand{true}));
  EXPECT_TRUE(IsGone());
  EXPECT_THAT(source_->status().state.english, HasSubstr("heartbeat"));
  EXPECT_THAT(source_->status().state.german, HasSubstr("Lebenszeichen"));
  const std::int64_t rows = sink_.rows();
  EXPECT_FALSE(sink_.WaitForMore(1, 0.2));
  EXPECT_EQ(sink_.rows(), rows);
  ASSERT_TRUE(press_.server().Do(FreezeCommand{false}));
  EXPECT_LT(Recovery(), 0.2);
}

TEST_F(IllController, RefusedRegistersAreToldAndTheOthersGoOn) {
  source_->Stop();
  machine_.signals.push_back(machine_.signals[0]);
  machine_.signals[1].name = "y";
  // A float32 needs one more register than there are.
  machine_.signals[1].origin->As<ModbusOrigin>()->address = 65535;
  source_ = MakeModbusRegisterSource(machine_, RealTime, 1);
  ASSERT_TRUE(source_->Start(sink_.sink()));
  EXPECT_TRUE(sink_.WaitForMore(3));
  EXPECT_TRUE(WaitUntil([&] { return source_->status().exceptions >= 2; }));
  EXPECT_TRUE(source_->status().connected);
  EXPECT_THAT(source_->status().state.english, HasSubstr("Illegal data address"));
}

TEST_F(IllController, MoreRegistersThanARequestMayAskForAreRefusedBeforeTheyAreSent) {
  ModbusLink link("127.0.0.1", press_.port(), 1, 0.1);
  ASSERT_EQ(link.Connect(), LinkOutcome::kDone);
  std::array<std::uint16_t, 126> too_many{};
  EXPECT_NE(link.Read(0, too_many), LinkOutcome::kDone);
  EXPECT_THAT(link.problem().english, HasSubstr("Too many data"));
}

TEST_F(IllController, ARequestWithAnUnknownFunctionHoldsUpNoOtherClient) {
  const int stranger = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(press_.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(connect(stranger, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  const std::array<std::uint8_t, 10> unknown = {0, 1, 0, 0, 0, 4, 1, 0x41, 0, 0};
  const std::array<std::uint8_t, 5> half = {0, 2, 0, 0, 0};
  ASSERT_EQ(write(stranger, unknown.data(), unknown.size()), static_cast<ssize_t>(unknown.size()));
  ASSERT_EQ(write(stranger, half.data(), half.size()), static_cast<ssize_t>(half.size()));
  EXPECT_LT(Recovery(), 0.3);
  EXPECT_EQ(source_->status().timeouts, 0);
  close(stranger);
}

TEST_F(IllController, ASweepIsRefusedWhileThePressWorksAndRunsWhileItRests) {
  ValveRequest request(*machine_.Source<ModbusSpec>());
  const auto decided = [&] {
    const auto status = request.Poll();
    return status && *status != SweepStatus::kUndecided;
  };
  ASSERT_TRUE(request.Ask(1, 0.05));
  ASSERT_TRUE(WaitUntil(decided));
  EXPECT_EQ(*request.Poll(), SweepStatus::kBusy);

  ASSERT_TRUE(press_.server().Do(PauseCommand{true}));
  ASSERT_TRUE(WaitUntil(
      [&] {
        EXPECT_TRUE(request.Ask(1, 0.05));
        EXPECT_TRUE(WaitUntil(decided));
        return *request.Poll() == SweepStatus::kRunning;
      },
      20));
  ASSERT_TRUE(press_.server().Do(PauseCommand{false}));
  EXPECT_TRUE(WaitUntil([&] { return *request.Poll() == SweepStatus::kBroken; }));

  ASSERT_TRUE(request.Ask(5, 0.05));
  ASSERT_TRUE(WaitUntil(decided));
  EXPECT_EQ(*request.Poll(), SweepStatus::kRefused) << "there are two axes";
}

TEST_F(IllController, ASweepThatCannotBeAskedForSaysWhy) {
  ModbusSpec spec = *machine_.Source<ModbusSpec>();
  EXPECT_THAT(ValveRequest(spec).Ask(0, 3).error().text, HasSubstr("amplitude 3"));
  press_.Kill();
  EXPECT_THAT(ValveRequest(spec).Ask(0, 0.05).error().text, HasSubstr("not reached"));
  spec.sweep.reset();
  EXPECT_THAT(ValveRequest(spec).Ask(0, 0.05).error().text, HasSubstr("sweep"));
}

TEST(Backoff, GrowsToItsLimitWithSomeChanceAndIsTheSameAgain) {
  Backoff one(0.1, 2, 7), two(0.1, 2, 7), other(0.1, 2, 8);
  double most = 0.1;
  bool differs = false;
  for (int k = 0; k < 10; ++k) {
    const double pause = one.Next();
    EXPECT_LE(pause, most);
    EXPECT_GE(pause, most / 2);
    EXPECT_EQ(pause, two.Next());
    differs |= pause != other.Next();
    most = std::min(2 * most, 2.0);
  }
  EXPECT_TRUE(differs);
  one.Reset();
  EXPECT_LE(one.Next(), 0.1);
}

}  // namespace
}  // namespace hydroscope
