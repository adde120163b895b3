#include "replay/held_signals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "replay/two_signals_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

constexpr int kRowsOfTasks = 3000, kHeld = 4;

double Position(int row) { return 0.1 * std::sin(0.002 * row); }

/// Rows 2 ms apart: p is noise, z is new every `kHeld` rows and NaN in row 1001.
std::string LogOfTwoTasks() {
  const std::string path = testing::TempDir() + "held_signals.csv";
  std::ofstream log(path);
  log.precision(12);
  log << "t,p,z\n";
  std::mt19937 random(3);
  for (int k = 0; k < kRowsOfTasks; ++k) {
    log << 0.002 * k << "," << random() % 100000 << ",";
    k == 1001 ? log << "nan\n" : log << Position(k - k % kHeld) << "\n";
  }
  return path;
}

TEST(HeldSignals, AreDrawnStraightBetweenNewReadings) {
  const auto reader = OpenLog(LogOfTwoTasks(), MachineOfTwoSignals());
  ASSERT_TRUE(reader) << reader.error().text;
  EXPECT_THAT((*reader)->counters().time_base.english, HasSubstr("z every 4 rows"));
  SampleBlock all, block;
  all.Resize(2, 0);
  while ((*reader)->Read(block, 123).value() > 0) {
    all.time.insert(all.time.end(), block.time.begin(), block.time.end());
    for (int s = 0; s < 2; ++s)
      all.signal[s].insert(all.signal[s].end(), block.signal[s].begin(), block.signal[s].end());
  }
  ASSERT_EQ(all.rows(), static_cast<std::size_t>(kRowsOfTasks));
  EXPECT_EQ((*reader)->counters().rows, kRowsOfTasks);
  for (int k = 0; k < kRowsOfTasks - kHeld; ++k) {
    ASSERT_NEAR(all.time[k], 0.002 * k, 1e-9);
    if (k >= 1000 && k < 1000 + kHeld) continue;  // one of them is none
    ASSERT_NEAR(all.signal[1][k], Position(k), 2e-6) << k;
  }
  EXPECT_NEAR(all.signal[1][1002], Position(1000), 1e-9) << "no line over a reading that is none";
}

/// Rows of a held signal, at the same time from row 10 on; it cannot be read beyond row 100.
class TornLog : public LogReader {
 public:
  Result<std::size_t> Read(SampleBlock& block, std::size_t max_rows) override {
    if (next_ == 100) return tl::unexpected(Error{ErrorKind::kBadInput, "torn"});
    const std::size_t rows = std::min<std::size_t>(max_rows, 100 - next_);
    block.Resize(1, rows);
    for (std::size_t k = 0; k < rows; ++k, ++next_) {
      block.time[k] = 0.002 * static_cast<double>(std::min<std::size_t>(next_, 10));
      block.signal[0][k] = static_cast<double>(next_ / kHeld);
      block.quality[0][k] = quality::kGood;
    }
    return rows;
  }
  double Progress() const override { return 0; }
  double SamplePeriod() const override { return 0.002; }
  const LogCounters& counters() const override { return counters_; }

 private:
  std::size_t next_ = 0;
  LogCounters counters_;
};

TEST(HeldSignals, OfATornLogAreGivenOutToItsLastRow) {
  const auto reader = WithDrawnSignals(std::make_unique<TornLog>(), {{0}, {}});
  std::vector<double> values;
  SampleBlock block;
  auto read = reader->Read(block, 30);
  for (; read && *read > 0; read = reader->Read(block, 30))
    values.insert(values.end(), block.signal[0].begin(), block.signal[0].end());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().text, "torn");
  ASSERT_EQ(values.size(), 100u);
  EXPECT_EQ(values[2], 0.5);
  for (const double value : values) EXPECT_TRUE(std::isfinite(value));
}

TEST(HeldSignals, RestingOrCoarseOnesAreNone) {
  SampleBlock head;
  head.Resize(2, 1000);
  std::mt19937 random(5);
  for (int k = 0; k < 1000; ++k) {
    head.signal[0][k] = static_cast<double>(random() % 1000);
    head.signal[1][k] = k < 800 ? 0.3 : 1e-3 * std::floor(0.37 * k);
  }
  EXPECT_FALSE(FindHeldSignals(head, MachineOfTwoSignals()));
}

}  // namespace
}  // namespace hydroscope
