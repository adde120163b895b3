#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "acquisition/modbus/link.h"
#include "alarms/feeds/modbus/register_map.h"
#include "alarms/feeds/modbus/settings.h"
#include "core/registers.h"
#include "tests/feed_fixture.h"

namespace hydroscope {
namespace {

using namespace register_map;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

/// A TCP connection without any idea of Modbus.
class Plain {
 public:
  explicit Plain(int port, const char* from = "127.0.0.1") : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    inet_pton(AF_INET, from, &address.sin_addr);
    bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~Plain() { close(socket_); }
  Plain(const Plain&) = delete;
  Plain& operator=(const Plain&) = delete;

  bool connected() const { return connected_; }
  bool Send(const Bytes& bytes) const {
    return send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
  }
  /// What comes within the time; `closed` if the other side ended it.
  struct Heard {
    Bytes bytes;
    bool closed = false;
  };
  Heard Hear(int milliseconds) const {
    pollfd waiting{socket_, POLLIN, 0};
    if (poll(&waiting, 1, milliseconds) <= 0) return {};
    Bytes bytes(4096);
    const ssize_t got = recv(socket_, bytes.data(), bytes.size(), 0);
    if (got <= 0) return {{}, true};
    bytes.resize(static_cast<std::size_t>(got));
    return {bytes, false};
  }

 private:
  int socket_;
  bool connected_ = false;
};

const Bytes kReadMagic = {0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 2};

class ModbusFeedTest : public FeedTest {
 protected:
  void Start(ModbusFeedSpec spec = {}, std::shared_ptr<const HealthBoard> board = nullptr) {
    spec.port = 0;
    PartsSpec feeds;
    feeds.Add(spec);
    feeds_.reset();
    feeds_.emplace(Feeds::Start(Press(feeds), database(), RealTime, std::move(board)));
    ASSERT_TRUE(WaitUntil([&] { return status().connected; }));
    const std::string name = status().name;
    port_ = std::stoi(name.substr(name.rfind(':') + 1));
    ASSERT_TRUE(WaitUntil([&] { return Words(kMagic, 1) == std::vector<std::uint16_t>{kMagic0}; }));
  }
  FeedStatus status() const { return feeds_->status().front(); }
  int port() const { return port_; }
  void Connect(ModbusLink& link) const {
    ASSERT_EQ(link.Connect(), LinkOutcome::kDone) << link.problem().english;
  }
  std::vector<std::uint16_t> Words(int first, int count) const {
    ModbusLink link("127.0.0.1", port_, 1, 1);
    std::vector<std::uint16_t> words(static_cast<std::size_t>(count));
    if (link.Connect() != LinkOutcome::kDone || link.Read(first, words) != LinkOutcome::kDone) return {};
    return words;
  }
  std::uint64_t Number(int first) const {
    const auto words = Words(first, 2);
    return words.empty() ? 0 : DecodeUnsigned(words);
  }

 private:
  std::optional<Feeds> feeds_;
  int port_ = 0;
};

TEST_F(ModbusFeedTest, ShowsAlarmsAndJournalOfBothAxes) {
  Raise("left", 1);
  Start();
  Raise("right", 1);
  ASSERT_TRUE(WaitUntil([&] { return Number(kNewest) == 2; }));
  EXPECT_THAT(Words(kAxes, 4), ElementsAre(2, 2, 2, 2)) << "axes, alarms, standing, not acknowledged";
  EXPECT_EQ(Words(kFirstAxis + kHealth, 1)[0], 2) << "out of specification";
  const auto second = Words(kFirstAlarm + kAlarmStride, kAlarmStride);
  EXPECT_EQ(second[kFlags], kActive);
  EXPECT_EQ(second[kAlarmAxis], 2);
  EXPECT_EQ(DecodeUnsigned(std::span(second).subspan(kAlarmSequence, 2)), 2u);
  const auto record = Words(kFirstRecord + 2 * kRecordWidth, kRecordWidth);
  EXPECT_EQ(record[kAlarmNumber], 2);
  EXPECT_EQ(record[kEvent], 1);
  EXPECT_EQ(
      DecodeRegisters(std::span(record).subspan(kRecordValue, 2), RegisterType::kFloat32, WordOrder::kAbcd),
      2);
  EXPECT_EQ(status().delivered, 2);
  ASSERT_FALSE(status().registers.empty());
  EXPECT_GT(status().registers.front().values.at(kHeartbeat), 0);
  EXPECT_EQ(status().behind, 0);
}

TEST_F(ModbusFeedTest, AnAxisThatIsBeingLearnedIsNotGood) {
  BeginLearning("left");
  Start();
  EXPECT_EQ(Words(kFirstAxis + kHealth, 1)[0], 3) << "function check";
  EXPECT_EQ(Words(kFirstHealth, 1)[0], static_cast<int>(HealthReason::kLearning));
}

TEST_F(ModbusFeedTest, HealthIsThatOfTheServiceAlsoWhereTheJournalCannotBeRead) {
  const auto board = std::make_shared<HealthBoard>();
  board->TellAxis("press/left",
                  JudgeHealth({.alarms = {}, .learned = 19, .needed = 100, .not_judged = {}, .trouble = {}}));
  Start({}, board);
  ASSERT_TRUE(WaitUntil([&] { return Words(kFirstHealth, 3) == std::vector<std::uint16_t>{2, 19, 100}; }));
  ASSERT_TRUE(journal().Change("press/left", 1, [](AxisContent&) -> Status { return {}; }));
  std::filesystem::resize_file(AlarmJournal::PathFor(database()), 100);  // damaged while it is open
  board->TellTrouble(HealthBoard::Part::kStoring, {HealthReason::kDiskFull, {"the disk is full", ""}});
  ASSERT_TRUE(WaitUntil([&] { return Words(kFirstAxis + kHealth, 1)[0] == 4; })) << "failure";
  EXPECT_EQ(Words(kTrouble, 1)[0], static_cast<int>(HealthReason::kDiskFull));
  const auto beat = Words(kHeartbeat, 1);
  EXPECT_TRUE(WaitUntil([&] { return Words(kHeartbeat, 1) != beat; })) << "the picture is current";
}

TEST_F(ModbusFeedTest, ThePressItselfStandsBehindItsAxesOnceItHasAnAlarm) {
  Raise("left", 1);
  Start();
  EXPECT_EQ(Words(kAxes, 1)[0], 2);
  RaiseOfPress("supply_or_oil");
  ASSERT_TRUE(WaitUntil([&] { return Number(kNewest) == 2; }));
  EXPECT_THAT(Words(kAxes, 4), ElementsAre(3, 2, 2, 2)) << "axes, alarms, standing, not acknowledged";
  EXPECT_EQ(Words(kFirstAxis + 2 * kAxisStride + kHealth, 1)[0], 1) << "maintenance required";
  const auto alarm = Words(kFirstAlarm + kAlarmStride, kAlarmStride);
  EXPECT_EQ(alarm[kFlags], kActive);
  EXPECT_EQ(alarm[kAlarmAxis], 3);
}

TEST_F(ModbusFeedTest, AlarmsKeepTheirNumbersWhenTheServiceStartsAgain) {
  Raise("right", 5);
  Raise("left", 1);
  Start();
  EXPECT_EQ(Words(kFirstAlarm + kAlarmAxis, 1)[0], 2);
  Start();
  EXPECT_EQ(Words(kFirstAlarm + kAlarmAxis, 1)[0], 2);
  EXPECT_EQ(Words(kFirstAlarm + kAlarmStride + kAlarmAxis, 1)[0], 1);
}

TEST_F(ModbusFeedTest, AnAcknowledgementIsStoredInTheJournalUnderTheNameOfTheFeed) {
  Raise("left", 1, 2);
  Start();
  ModbusLink link("127.0.0.1", port(), 1, 1);
  Connect(link);
  ASSERT_EQ(link.WriteRegister(kAcknowledge, 2), LinkOutcome::kDone) << link.problem().english;
  ASSERT_TRUE(WaitUntil([&] {
    return Words(kAcknowledge, 2) == std::vector<std::uint16_t>{2, kAcknowledged};
  }));
  EXPECT_TRUE(StateOf("left", 2).acknowledged);
  EXPECT_FALSE(StateOf("left", 1).acknowledged);
  const auto rows = journal().Rows("", 2);
  ASSERT_EQ(rows->size(), 1u);
  EXPECT_EQ(rows->front().event.event, "acknowledged");
  EXPECT_EQ(rows->front().event.user, "modbus");
  EXPECT_EQ(rows->front().event.comment, "from 127.0.0.1");
  ASSERT_EQ(link.WriteRegister(kAcknowledge, 2), LinkOutcome::kDone);
  EXPECT_TRUE(WaitUntil([&] { return Words(kAcknowledgeOutcome, 1)[0] == kNothingToAcknowledge; }));
}

TEST_F(ModbusFeedTest, WhatMayNotBeWrittenIsRefused) {
  Raise("left", 1);
  Start();
  ModbusLink link("127.0.0.1", port(), 1, 1);
  Connect(link);
  EXPECT_EQ(link.WriteRegister(kHeartbeat, 1), LinkOutcome::kException);
  EXPECT_THAT(link.problem().english, HasSubstr("Illegal data address"));
  EXPECT_EQ(link.WriteRegister(kAcknowledge, 2), LinkOutcome::kException);
  EXPECT_THAT(link.problem().english, HasSubstr("Illegal data value"));
  EXPECT_EQ(link.WriteCoil(kAcknowledge, true), LinkOutcome::kException);
  EXPECT_THAT(link.problem().english, HasSubstr("Illegal function"));
  EXPECT_FALSE(StateOf("left", 1).acknowledged);
}

TEST_F(ModbusFeedTest, NonsenseIsAnsweredOrClosedWithin50MillisecondsWhileOthersAreServed) {
  Start();
  const Plain sound(port());
  for (const Bytes& nonsense : {Bytes{0}, Bytes{0, 1, 0, 0, 0}, Bytes{0, 1, 0, 0, 0, 6, 1, 3, 0},
                                Bytes{0, 1, 0, 7, 0, 6, 1, 3, 0, 0, 0, 1}, Bytes{0, 1, 0, 0, 0, 0, 1},
                                Bytes{0, 1, 0, 0, 255, 255, 1, 3}, Bytes(300, 0x55), Bytes(300, 0),
                                Bytes{0, 1, 0, 0, 0, 2, 1, 99}, Bytes{0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 1, 0}}) {
    double quickest = 1;  // of three: the test may be held up itself
    for (int k = 0; k < 3; ++k) {
      const Plain client(port());
      ASSERT_TRUE(client.Send(nonsense));
      const double begin = Now();
      const auto heard = client.Hear(500);
      EXPECT_TRUE(heard.closed || !heard.bytes.empty());
      quickest = std::min(quickest, Now() - begin);
    }
    EXPECT_LT(quickest, 0.05) << testing::PrintToString(nonsense);
    EXPECT_THAT(status().refusal,
                testing::AnyOf("", "127.0.0.1 sent what is no Modbus", "127.0.0.1 did not end its request"));
    ASSERT_TRUE(sound.Send(kReadMagic));
    EXPECT_EQ(sound.Hear(500).bytes.size(), 13u);
  }
}

TEST_F(ModbusFeedTest, AClientThatHoldsHalfARequestDoesNotSlowAnother) {
  Start();
  ModbusLink link("127.0.0.1", port(), 1, 1);
  Connect(link);
  std::vector<std::uint16_t> words(125);
  std::vector<double> times;
  for (int k = 0; k < 20; ++k) {
    const Plain slow(port());
    slow.Send({0, 1, 0});
    for (int read = 0; read < 5; ++read) {
      const double begin = Now();
      ASSERT_EQ(link.Read(0, words), LinkOutcome::kDone) << link.problem().english;
      times.push_back(Now() - begin);
    }
  }
  std::sort(times.begin(), times.end());
  EXPECT_LT(times[times.size() / 2], 0.01);
  EXPECT_LT(times[times.size() * 9 / 10], 0.05);
}

TEST_F(ModbusFeedTest, AClientThatDoesNotReadItsAnswersIsClosed) {
  Start();
  const Plain deaf(port());
  Bytes requests;
  for (int k = 0; k < 80; ++k) requests.insert(requests.end(), {0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 125});
  bool refused = false;
  EXPECT_TRUE(WaitUntil([&] {
    for (int k = 0; k < 100 && !refused; ++k) refused = !deaf.Send(requests);
    return refused;
  }));
  EXPECT_EQ(Words(kMagic, 1)[0], kMagic0);
}

TEST_F(ModbusFeedTest, ManyClientsReadAtTheSameTime) {
  Start();
  std::vector<std::unique_ptr<Plain>> clients;
  for (int k = 0; k < 16; ++k) clients.push_back(std::make_unique<Plain>(port()));
  for (int round = 0; round < 50; ++round) {
    for (const auto& client : clients) ASSERT_TRUE(client->Send(kReadMagic));
    for (const auto& client : clients) ASSERT_EQ(client->Hear(1000).bytes.size(), 13u);
  }
}

TEST_F(ModbusFeedTest, ConnectionsBeyondTheLimitAreClosedAtOnce) {
  Start({.connections = 2});
  ASSERT_TRUE(WaitUntil([&] { return status().clients == 0; }));
  const Plain first(port()), second(port());
  ASSERT_TRUE(first.Send(kReadMagic) && second.Send(kReadMagic));
  EXPECT_FALSE(first.Hear(500).bytes.empty());
  EXPECT_FALSE(second.Hear(500).bytes.empty());
  EXPECT_TRUE(Plain(port()).Hear(500).closed);
  EXPECT_THAT(status().state.english, HasSubstr("1 refused"));
  EXPECT_EQ(status().refused, 1);
  EXPECT_THAT(status().refusal, HasSubstr("127.0.0.1 found all [feeds.modbus] connections taken"));
}

TEST_F(ModbusFeedTest, TheConnectionThatIsIdleLongestGivesWayToAnother) {
  Start({.connections = 2});
  const Plain idle(port()), busy(port());
  const double begin = Now();
  while (Now() - begin < 1.3) {
    ASSERT_TRUE(busy.Send(kReadMagic));
    ASSERT_FALSE(busy.Hear(500).bytes.empty());
  }
  const Plain third(port());
  ASSERT_TRUE(third.Send(kReadMagic));
  EXPECT_FALSE(third.Hear(500).bytes.empty());
  EXPECT_TRUE(idle.Hear(500).closed);
  ASSERT_TRUE(busy.Send(kReadMagic));
  EXPECT_FALSE(busy.Hear(500).bytes.empty());
}

TEST_F(ModbusFeedTest, ConnectionsThatNeverAskedGiveWayBeforeAPollerThatRests) {
  Start({.connections = 2});
  const Plain poller(port());
  const auto ask = [](const Plain& client) {
    return client.Send(kReadMagic) && !client.Hear(500).bytes.empty();
  };
  ASSERT_TRUE(ask(poller));
  for (int k = 0; k < 8; ++k) {
    const Plain silent(port());
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    const Plain next(port());  // in the place of the silent one, not of the poller
    EXPECT_TRUE(ask(next)) << k;
    EXPECT_TRUE(ask(poller)) << k;
  }
}

TEST_F(ModbusFeedTest, WithoutTheRightToAcknowledgeClientsOnlyRead) {
  Raise("left", 1);
  Start({.acknowledge = false});
  ModbusLink link("127.0.0.1", port(), 1, 1);
  Connect(link);
  EXPECT_EQ(link.WriteRegister(kAcknowledge, 1), LinkOutcome::kException);
  EXPECT_THAT(link.problem().english, HasSubstr("Illegal data address"));
  EXPECT_FALSE(StateOf("left", 1).acknowledged);
}

TEST_F(ModbusFeedTest, AnIdleConnectionIsClosed) {
  Start({.idle_timeout = 0.2});
  const Plain client(port());
  const double begin = Now();
  EXPECT_TRUE(client.Hear(2000).closed);
  EXPECT_GE(Now() - begin, 0.15);
}

TEST_F(ModbusFeedTest, ClientsThatAreNotAllowedAreClosedAtOnce) {
  Start({.allow = {"127.0.0.1"}});
  EXPECT_TRUE(Plain(port(), "127.0.0.2").Hear(500).closed);
  EXPECT_EQ(status().refusal, "127.0.0.2 is not among [feeds.modbus] allow");
  const Plain allowed(port(), "127.0.0.1");
  ASSERT_TRUE(allowed.Send(kReadMagic));
  EXPECT_FALSE(allowed.Hear(500).bytes.empty());
}

TEST_F(ModbusFeedTest, APortThatIsTakenIsToldAndTriedAgain) {
  Start();
  PartsSpec same;
  same.Add<ModbusFeedSpec>().port = port();
  const Feeds second = Feeds::Start(Press(same), database(), RealTime);
  ASSERT_TRUE(WaitUntil([&] { return second.status()[0].errors > 0; }));
  EXPECT_FALSE(second.status()[0].connected);
  EXPECT_THAT(second.status()[0].state.english, HasSubstr("cannot be opened"));
}

/// Reads the ring once, as a SCADA system that knows the map; appends what is new.
void Poll(ModbusLink& link, std::vector<std::int64_t>& sequences) {
  std::vector<std::uint16_t> head(kHeadSize);
  ASSERT_EQ(link.Read(0, head), LinkOutcome::kDone) << link.problem().english;
  const auto newest = static_cast<std::int64_t>(DecodeUnsigned(std::span(head).subspan(kNewest, 2)));
  for (std::int64_t next = sequences.empty() ? 1 : sequences.back() + 1; next <= newest;) {
    const auto record = static_cast<int>(next % kRingRecords);
    const auto count =
        static_cast<int>(std::min<std::int64_t>({newest - next + 1, kRingRecords - record, 7}));
    std::vector<std::uint16_t> words(static_cast<std::size_t>(count * kRecordWidth));
    ASSERT_EQ(link.Read(kFirstRecord + record * kRecordWidth, words), LinkOutcome::kDone);
    for (int k = 0; k < count; ++k, ++next)
      sequences.push_back(static_cast<std::int64_t>(
          DecodeUnsigned(std::span(words).subspan(static_cast<std::size_t>(k * kRecordWidth), 2))));
  }
}

TEST_F(ModbusFeedTest, APollerAtOneHertzMissesNoneOfAThousandAlarmsInASecond) {
  Start();
  std::jthread writer([&] {
    for (int k = 0; k < 20; ++k) {
      const double begin = Now();
      Raise(k % 2 == 0 ? "left" : "right", 1 + 25 * k, 50);
      std::this_thread::sleep_for(std::chrono::duration<double>(std::max(0.0, begin + 0.05 - Now())));
    }
  });
  ModbusLink link("127.0.0.1", port(), 1, 1);
  Connect(link);
  std::vector<std::int64_t> sequences;
  const double end = Now() + 20;
  while (sequences.size() < 1000 && Now() < end) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    Poll(link, sequences);
  }
  ASSERT_EQ(sequences.size(), 1000u);
  for (std::size_t k = 0; k < sequences.size(); ++k)
    ASSERT_EQ(sequences[k], static_cast<std::int64_t>(k + 1));
}

}  // namespace
}  // namespace hydroscope
