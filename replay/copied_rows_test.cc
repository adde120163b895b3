#include "replay/copied_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "replay/two_signals_fixture.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

constexpr int kRows = 3000;

/// Rows of noise 2 ms apart, one in 37 written twice; their stamps in steps of `clock` s.
std::string LogWithCopies(double clock) {
  const std::string path = testing::TempDir() + "copied_rows.csv";
  std::ofstream log(path);
  log << "t,p,z\n";
  std::mt19937 random(3);
  for (int k = 0; k < kRows; ++k) {
    const double t = std::floor(0.002 * k / clock + 1e-9) * clock;
    const std::string row =
        std::to_string(t) + "," + std::to_string(random() % 100000) + "," + std::to_string(random() % 100000);
    log << row << "\n";
    if (k % 37 == 5) log << row << "\n";
  }
  return path;
}

struct WhatIsRead {
  std::vector<double> times;
  LogCounters counters;
};

WhatIsRead ReadAll(const std::string& path) {
  auto reader = OpenLog(path, MachineOfTwoSignals());
  EXPECT_TRUE(reader) << reader.error().text;
  WhatIsRead read;
  SampleBlock block;
  while ((*reader)->Read(block, 100).value() > 0)
    read.times.insert(read.times.end(), block.time.begin(), block.time.end());
  read.counters = (*reader)->counters();
  return read;
}

TEST(CopiedRows, AreLeftOutAndTold) {
  const WhatIsRead read = ReadAll(LogWithCopies(0.0001));
  ASSERT_EQ(read.times.size(), static_cast<std::size_t>(kRows));
  for (std::size_t k = 0; k < read.times.size(); ++k)
    ASSERT_NEAR(read.times[k], 2e-3 * static_cast<double>(k), 1e-6);
  EXPECT_EQ(read.counters.rows, kRows);
  for (const std::int64_t flagged : read.counters.flagged) EXPECT_EQ(flagged, 0);
  EXPECT_THAT(read.counters.time_base.english, HasSubstr("writes one row in 36 twice"));
}

/// Five rows share a stamp of 10 ms, each with readings of its own; a copy then counts as a row of its own.
TEST(CopiedRows, AreNotLookedForWhereStampsAreCoarse) {
  EXPECT_THAT(ReadAll(LogWithCopies(0.01)).counters.time_base.english, ::testing::Not(HasSubstr("twice")));
}

}  // namespace
}  // namespace hydroscope
