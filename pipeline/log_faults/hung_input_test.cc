#include "pipeline/log_faults/hung_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/records/quality.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

constexpr std::size_t kFed = 0, kLevel = 1, kHungRows = 4000, kHangsFrom = 1500, kHangsTo = 2200;

Machine FedTank(const std::string& of_input = ", stuck_time = 1") {
  const auto machine =
      ParseMachine("[signals]\nq = { column = \"q\", unit = \"1\"" + of_input +
                       " }\nlevel = { column = \"level\", unit = \"V\" }\n"
                       "[states]\nh = { ddt = \"k*q\", unit = \"V\" }\n[outputs]\nlevel = \"h\"\n"
                       "[parameters]\nk = { start = 1, min = 0, max = 2 }\n",
                   "tank.toml");
  EXPECT_TRUE(machine) << machine.error().text;
  return *machine;
}

/// An input with noise that swings, repeats one reading between two rows, and an output that goes on moving or rests meanwhile.
SampleBlock HungRows(double noise, bool output_moves) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  SampleBlock rows;
  rows.Resize(2, kHungRows);
  for (std::size_t k = 0; k < kHungRows; ++k) {
    const double t = 0.01 * static_cast<double>(k);
    const bool held = k >= kHangsFrom && k < kHangsTo;
    rows.time[k] = t;
    rows.signal[kFed][k] = held ? rows.signal[kFed][kHangsFrom - 1] : std::sin(t) + noise * normal(random);
    rows.signal[kLevel][k] = std::cos(held && !output_moves ? 0.01 * kHangsFrom : t) + 1e-3 * normal(random);
    if (held) rows.quality[kFed][k] |= quality::kStuck;
  }
  return rows;
}

std::vector<FrozenStretch> HungIn(const Machine& machine, const SampleBlock& rows) {
  return HungInputs(machine, std::vector<int>{0}, std::vector<int>{1}, rows);
}

TEST(HungInputs, AMeasuredInputThatRepeatsAReadingWhileTheMachineMovesHung) {
  SampleBlock rows = HungRows(0.01, true);
  const auto hung = HungIn(FedTank(), rows);
  ASSERT_EQ(hung.size(), 1u);
  EXPECT_NEAR(hung[0].begin, 15, 0.02);
  EXPECT_NEAR(hung[0].end, 22, 0.02);
  EXPECT_THAT(HungTexts(hung, FedTank()).front().english,
              HasSubstr("q (column q) repeats one reading from 15.00 to 21.99 s while outputs"));
  LeaveOutHung(hung, rows);
  EXPECT_TRUE(std::isnan(rows.signal[kFed][kHangsFrom + 10]));
  EXPECT_TRUE(std::isfinite(rows.signal[kFed][kHangsTo + 10]));
}

TEST(HungInputs, ACommandWithoutNoiseRests) { EXPECT_TRUE(HungIn(FedTank(), HungRows(0, true)).empty()); }

TEST(HungInputs, AnInputThatIsHeldWhileTheMachineSettlesRests) {
  EXPECT_TRUE(HungIn(FedTank(), HungRows(0.01, false)).empty());
}

TEST(HungInputs, ASignalThatIsNeverStuckRests) {
  EXPECT_TRUE(HungIn(FedTank(", stuck_time = 0"), HungRows(0.01, true)).empty());
}

TEST(HungInputs, OfInputsThatNeverMoveAWordIsSaidWhereOutputsGoOnMoving) {
  SampleBlock rows = HungRows(0, true);
  const auto said = [&] {
    return NoInputMoves(FedTank(), std::vector<int>{0}, std::vector<int>{1}, rows).english;
  };
  EXPECT_EQ(said(), "");
  for (double& reading : rows.signal[kFed]) reading = 3;
  EXPECT_THAT(said(), HasSubstr("one and the same reading in the whole log of every input (q (column q))"));
  for (std::size_t k = 0; k < kHungRows; ++k)
    rows.signal[kLevel][k] = std::exp(-0.01 * static_cast<double>(k));
  EXPECT_EQ(said(), "") << "it settles";
}

}  // namespace
}  // namespace hydroscope
