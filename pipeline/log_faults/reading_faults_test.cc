#include "pipeline/log_faults/reading_faults.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace hydroscope {
namespace {

/// What is said of a minute of strokes of a cushion whose position reads `disturbed(row, position)`.
Told NoVerdictOf(const std::function<double(int, double)>& disturbed) {
  const auto machine = LoadMachine(HYDROSCOPE_SOURCE_DIR "/machines/die_cushion.toml");
  EXPECT_TRUE(machine) << machine.error().text;
  const auto z = static_cast<std::size_t>(machine->SignalIndex("z"));
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 2e-5);
  SampleBlock rows;
  rows.Resize(machine->signals.size(), 30000);
  for (int row = 0; row < 30000; ++row) {
    const auto k = static_cast<std::size_t>(row);
    rows.time[k] = 0.002 * row;
    rows.signal[z][k] = disturbed(row, 0.1 + 0.08 * std::cos(0.002 * row)) + noise(random);
  }
  std::vector<ChannelQuality> channels(machine->signals.size());
  for (ChannelQuality& channel : channels) channel.noise_std = 2e-5;
  ReadingFaults faults(*machine, 0.002);
  faults.Observe(rows, channels);
  return faults.NoVerdict();
}

TEST(ReadingFaults, APositionThatJumpsAndStaysThereGivesNoVerdict) {
  const auto counter = [](int row, double z) { return z + 0.003 * (row / 6000); };
  EXPECT_NE(NoVerdictOf(counter).english.find("jumps 4 times"), std::string::npos)
      << NoVerdictOf(counter).english;
}

/// Of a burst of disturbance two readings on end may lie close together, far from all others.
TEST(ReadingFaults, ABurstThatIsOverAfterSomeRowsIsNoJump) {
  const auto bursts = [](int row, double z) {
    constexpr double kBurst[] = {0.003, 0.003, 0.003, -0.002, 0.001};
    const int since = row % 1500 - 700;
    return since >= 0 && since < 5 ? z + kBurst[since] : z;
  };
  EXPECT_EQ(NoVerdictOf(bursts).english, "");
}

}  // namespace
}  // namespace hydroscope
