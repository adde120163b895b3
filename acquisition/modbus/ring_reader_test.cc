#include "acquisition/modbus/ring_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace hydroscope {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A controller's registers with a ring of 16 records: sequence, one float; head at 0: session, newest, time.
class Ring {
 public:
  static ModbusRingSpec Spec() {
    return {.session = 0,
            .newest = 2,
            .time = 4,
            .first = 100,
            .records = 16,
            .width = 4,
            .period = 1e-3,
            .poll_period = 1e-3};
  }
  explicit Ring(std::uint32_t session, std::uint32_t next = 0) : next_(next) {
    EncodeUnsigned(session, std::span(registers_).subspan(0, 2));
  }
  void Write(int rows) {
    for (int k = 0; k < rows; ++k, ++next_) {
      const auto record = std::span(registers_).subspan(100 + 4 * (next_ % 16), 4);
      EncodeUnsigned(next_, record.first(2));
      EncodeRegisters(next_ % 1000, RegisterType::kFloat32, WordOrder::kAbcd, record.subspan(2));
    }
    EncodeUnsigned(next_ - 1u, std::span(registers_).subspan(2, 2));
    EncodeUnsigned(1'000'000'000'000ull + next_ * 1'000'000ull, std::span(registers_).subspan(4, 4));
  }
  std::span<std::uint16_t> Read(RingReader::Range range) {
    return std::span(registers_)
        .subspan(static_cast<std::size_t>(range.first), static_cast<std::size_t>(range.count));
  }

 private:
  std::array<std::uint16_t, 200> registers_{};
  std::uint32_t next_;
};

class RingReaderTest : public ::testing::Test {
 protected:
  RingReaderTest() : reader_(Ring::Spec(), {{2, RegisterType::kFloat32, WordOrder::kAbcd, 5}}) {}

  void Poll(Ring& ring) {
    for (const RingReader::Request& request : reader_.Begin(ring.Read(*RingReader::Head(Ring::Spec()))))
      reader_.Receive(request, ring.Read(request.registers), {1, 1}, {2, 2},
                      [&](SampleBatch&& batch) { got_.push_back(std::move(batch)); });
  }
  std::vector<double> Values() const {
    std::vector<double> values;
    for (const SampleBatch& batch : got_)
      values.insert(values.end(), batch.values.begin(), batch.values.end());
    return values;
  }

  RingReader reader_;
  std::vector<SampleBatch> got_;
};

TEST_F(RingReaderTest, BeginsWithTheNewestAndThenLosesNothing) {
  Ring ring(1);
  ring.Write(10);
  Poll(ring);
  ring.Write(5);
  Poll(ring);
  ring.Write(9);
  Poll(ring);
  EXPECT_THAT(Values(), ElementsAre(9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23));
  EXPECT_EQ(reader_.counters().lost_rows, 0);
  EXPECT_EQ(reader_.counters().rows, 15);
}

TEST_F(RingReaderTest, EveryRowHasTheTimeOfTheSender) {
  Ring ring(1);
  ring.Write(1);
  Poll(ring);
  ring.Write(3);
  Poll(ring);
  ASSERT_EQ(got_.size(), 2u);
  EXPECT_EQ(got_[1].source_time_ns - got_[0].source_time_ns, 1'000'000);
  EXPECT_EQ(got_[1].rows, 3u);
  EXPECT_THAT(got_[1].channels, ElementsAre(5));
}

TEST_F(RingReaderTest, ReadingTooSeldomIsCountedAsLoss) {
  Ring ring(1);
  ring.Write(1);
  Poll(ring);
  ring.Write(100);
  Poll(ring);
  EXPECT_EQ(Values().back(), 100);
  EXPECT_EQ(reader_.counters().lost_rows, 100 - 14) << "14 of 16 records are trusted";
}

TEST_F(RingReaderTest, ARecordOverwrittenWhileReadingIsLostAndNotTaken) {
  Ring ring(1);
  ring.Write(1);
  Poll(ring);
  ring.Write(8);
  const auto requests = reader_.Begin(ring.Read(*RingReader::Head(Ring::Spec())));
  ring.Write(16);
  for (const auto& request : requests)
    EXPECT_FALSE(
        reader_.Receive(request, ring.Read(request.registers), {}, {}, [](SampleBatch&&) { FAIL(); }));
  EXPECT_EQ(reader_.counters().malformed, 0);
  Poll(ring);
  EXPECT_EQ(reader_.counters().lost_rows, 24 - 14);
}

TEST_F(RingReaderTest, NonsenseInARecordIsMalformed) {
  Ring ring(1);
  ring.Write(1);
  Poll(ring);
  ring.Write(2);
  ring.Read({105, 1})[0] = 77;
  Poll(ring);
  EXPECT_EQ(reader_.counters().malformed, 1);
  EXPECT_THAT(Values(), ElementsAre(0));
}

TEST_F(RingReaderTest, ANewSessionBeginsAnew) {
  Ring first(1), second(2);
  first.Write(500);
  Poll(first);
  second.Write(3);
  Poll(second);
  ASSERT_EQ(got_.size(), 2u);
  EXPECT_NE(got_[0].session, got_[1].session);
  EXPECT_EQ(reader_.counters().lost_rows, 0);
}

TEST_F(RingReaderTest, AControllerThatCountsFromZeroAgainIsANewLifeEvenWithTheSameSession) {
  Ring first(1), second(1);
  first.Write(500);
  Poll(first);
  second.Write(3);
  Poll(second);
  ASSERT_EQ(got_.size(), 2u);
  EXPECT_NE(got_[0].session, got_[1].session);
  EXPECT_EQ(got_[1].values.back(), 2);
}

TEST_F(RingReaderTest, TheSequenceNumberMayWrapAround) {
  Ring ring(1, 0xfffffffa);
  ring.Write(3);
  Poll(ring);
  ring.Write(6);
  Poll(ring);
  std::size_t rows = 0;
  for (const SampleBatch& batch : got_) {
    EXPECT_EQ(batch.first_sequence, got_.front().first_sequence + rows);
    rows += batch.rows;
  }
  EXPECT_EQ(rows, 7u);
  EXPECT_EQ(reader_.counters().lost_rows, 0);
}

TEST_F(RingReaderTest, AnImpossibleTimeIsNone) {
  Ring ring(1);
  ring.Write(1);
  for (std::uint16_t& word : ring.Read({4, 4})) word = 0xffff;
  Poll(ring);
  ASSERT_EQ(got_.size(), 1u);
  EXPECT_EQ(got_[0].source_time_ns, 0);
  EXPECT_EQ(reader_.counters().malformed, 1);
}

TEST_F(RingReaderTest, NothingNewIsNothingToRead) {
  Ring ring(1);
  ring.Write(4);
  Poll(ring);
  EXPECT_THAT(reader_.Begin(ring.Read(*RingReader::Head(Ring::Spec()))), IsEmpty());
}

TEST(RingHead, MustFitOneRequest) {
  ModbusRingSpec spec;
  spec.session = 0;
  spec.newest = 200;
  EXPECT_FALSE(RingReader::Head(spec));
}

}  // namespace
}  // namespace hydroscope
