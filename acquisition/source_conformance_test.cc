// What every source must do, whatever the wire: deliver, keep count, survive the sender, stop at once.
#include <gmock/gmock.h>

#include <cmath>

#include "acquisition/dds/dds_source.h"
#include "acquisition/modbus/modbus_source.h"
#include "tests/live_fixture.h"

namespace hydroscope {
namespace {

/// One kind of source and the network that its sender uses.
struct Kind {
  std::string name;
  bool dds = false;
  std::string transport;  ///< lines of [live.dds]
  DdsNetwork network;     ///< without the domain
  std::string signals;
  bool numbered = true;  ///< the sender numbers rows and has sessions
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

const std::string kDdsSignals =
    "p_A = { dds = \"{axis}/p_A\", unit = \"Pa\" }\nz = { dds = \"{axis}/z\", unit = \"m\" }\n"
    "y_v = { dds = \"{axis}/y_v\" }\n";

std::vector<Kind> Kinds() {
  const std::string loopback = "interfaces = [\"127.0.0.1\"]\n";
  return {
      {"DdsUdp",
       true,
       "transport = \"udp\"\n" + loopback,
       {.udp = true, .shared_memory = false, .interfaces = {"127.0.0.1"}, .peers = {}},
       kDdsSignals},
      {"DdsUdpWithoutMulticast",
       true,
       "transport = \"udp\"\npeers = [\"127.0.0.1\"]\n" + loopback,
       {.udp = true, .shared_memory = false, .interfaces = {"127.0.0.1"}, .peers = {"127.0.0.1"}},
       kDdsSignals},
      {"DdsSharedMemory",
       true,
       "transport = \"shm\"\n",
       {.udp = false, .shared_memory = true, .interfaces = {}, .peers = {}},
       kDdsSignals},
      {"ModbusRing",
       false,
       "",
       {},
       "p_A = { modbus = { ring = 0, stride = 14 }, unit = \"Pa\" }\nz = { modbus = { ring = 6, stride = 14 "
       "}, unit = \"m\" }\ny_v = { modbus = { ring = 8, stride = 14 } }\n"},
      {"ModbusRegisters",
       false,
       "",
       {},
       "p_A = { modbus = { register = 32 }, unit = \"bar\" }\nz = { modbus = { register = 42, "
       "stride = 4, type = \"uint32\" }, unit = \"m\" }\ny_v = { modbus = { register = 40, "
       "stride = 4, type = \"uint16\" } }\n",
       false},
  };
}

class SourceConformance : public ::testing::TestWithParam<Kind> {
 protected:
  SourceConformance() {
    const Kind& kind = GetParam();
    std::string text = "[live]\naxes = [\"left\", \"right\"]\n";
    if (kind.dds)
      text += fmt::format("[live.dds]\ndomain = {}\n{}", OwnDomain(), kind.transport);
    else
      text += fmt::format(
          "[live.modbus]\nport = {}\npoll_period = 0.02\nretry_limit = 0.2\nheartbeat = "
          "15\ntime = 8\nring = {{ session = 2, newest = 4, time = 8, first = 1000, records = "
          "1024, width = 30, poll_period = 0.01 }}\n",
          press_.port());
    text += "[signals]\n" + kind.signals + "[geometry]\nA_A = 0.0125\ndp_nom = 35e5\n";
    auto machine = ParseMachine(text, "press.toml");
    EXPECT_TRUE(machine) << machine.error().text;
    machine_ = *machine;
    if (kind.dds) {
      auto options = DdsOptionsFor(machine_);
      options.deaf_after = 3;
      source_ = MakeDdsSource(options, RealTime);
    } else if (kind.numbered) {
      source_ = MakeModbusRingSource(machine_, RealTime, 1);
    } else {
      source_ = MakeModbusRegisterSource(machine_, RealTime, 1);
    }
  }
  ~SourceConformance() override { source_->Stop(); }

  void Live() {
    std::optional<DdsNetwork> network;
    if (GetParam().dds) {
      network = GetParam().network;
      network->domain = OwnDomain();
    }
    press_.Live(network);
  }
  void Start() {
    const Status status = source_->Start(sink_.sink());
    ASSERT_TRUE(status) << status.error().text;
  }

  TestPress press_;
  TestSink sink_;
  Machine machine_;
  std::unique_ptr<Source> source_;
};

TEST_P(SourceConformance, DeliversEveryChannelInOrderWithStamps) {
  Live();
  Start();
  ASSERT_TRUE(sink_.WaitForMore(GetParam().numbered ? 500 : 20)) << source_->status().state.english;
  source_->Stop();
  std::uint64_t next = sink_.batches().front().first_sequence;
  for (const SampleBatch& batch : sink_.batches()) {
    EXPECT_EQ(batch.first_sequence, next) << "no row is missing on a sound wire";
    next += batch.rows;
    ASSERT_EQ(batch.values.size(), batch.rows * batch.channels.size());
    EXPECT_THAT(batch.channels, ::testing::UnorderedElementsAre(0, 1, 2, 3, 4, 5));
    for (const double value : batch.values) EXPECT_TRUE(std::isfinite(value));
    EXPECT_LE(batch.requested.monotonic_ns, batch.received.monotonic_ns);
    EXPECT_EQ(batch.period_ns, GetParam().numbered ? 1'000'000 : 0);
    const std::int64_t newest =
        batch.source_time_ns + static_cast<std::int64_t>(batch.rows - 1) * batch.period_ns;
    EXPECT_LT(newest, batch.received.wall_ns) << "no row comes from the future";
    EXPECT_GT(newest, batch.received.wall_ns - 60'000'000'000);
  }
  const SourceStatus status = source_->status();
  EXPECT_EQ(status.rows, sink_.rows());
  EXPECT_EQ(status.lost_rows, 0);
  EXPECT_EQ(status.malformed, 0);
  EXPECT_EQ(status.last_received.monotonic_ns, sink_.batches().back().received.monotonic_ns);
}

TEST_P(SourceConformance, WaitsForASenderThatComesLater) {
  Start();
  ASSERT_TRUE(WaitUntil([&] { return source_->status().state.english != "connecting"; }));
  EXPECT_FALSE(source_->status().connected);
  Live();
  EXPECT_TRUE(sink_.WaitForMore(5)) << source_->status().state.english;
  EXPECT_TRUE(WaitUntil([&] { return source_->status().connected; }));
}

TEST_P(SourceConformance, SurvivesTheSendersDeathAndTakesTheNextOne) {
  Live();
  Start();
  ASSERT_TRUE(sink_.WaitForMore(10)) << source_->status().state.english;
  press_.Kill();
  EXPECT_TRUE(WaitUntil([&] { return !source_->status().connected; }, 3)) << source_->status().state.english;
  EXPECT_NE(source_->status().state.english, "receiving");
  Live();
  EXPECT_TRUE(sink_.WaitForMore(10)) << source_->status().state.english;
  if (GetParam().numbered) {
    EXPECT_TRUE(sink_.WaitForSessions(2)) << "a new life is told by its session";
  }
  EXPECT_TRUE(WaitUntil([&] { return source_->status().connected; }));
  EXPECT_EQ(source_->status().duplicate_rows, 0);
}

TEST_P(SourceConformance, StopsAtOnceAndIsSilentAfterwards) {
  Live();
  Start();
  ASSERT_TRUE(sink_.WaitForMore(5)) << source_->status().state.english;
  const auto begin = std::chrono::steady_clock::now();
  source_->Stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
  const std::int64_t rows = sink_.rows();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(sink_.rows(), rows);
}

TEST_P(SourceConformance, StopsAtOnceWhileNobodySends) {
  Start();
  const auto begin = std::chrono::steady_clock::now();
  source_->Stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

INSTANTIATE_TEST_SUITE_P(Wires, SourceConformance, ::testing::ValuesIn(Kinds()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace hydroscope
