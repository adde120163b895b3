#include "replay/held_signals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

constexpr int kRowsOfTasks = 3000, kHeld = 4;

double Position(int row) { return 0.1 * std::sin(0.002 * row); }

Machine MachineOfTasks() {
  Machine machine;
  machine.log.time_column = "t";
  machine.log.time_unit = "s";
  for (const char* name : {"p", "z"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    signal.unit = "1";
    machine.signals.push_back(signal);
  }
  return machine;
}

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
  const auto reader = OpenLog(LogOfTwoTasks(), MachineOfTasks());
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

TEST(HeldSignals, RestingOrCoarseOnesAreNone) {
  SampleBlock head;
  head.Resize(2, 1000);
  std::mt19937 random(5);
  for (int k = 0; k < 1000; ++k) {
    head.signal[0][k] = static_cast<double>(random() % 1000);
    head.signal[1][k] = k < 800 ? 0.3 : 1e-3 * std::floor(0.37 * k);
  }
  EXPECT_FALSE(FindHeldSignals(head, MachineOfTasks()));
}

}  // namespace
}  // namespace hydroscope
