#include "pipeline/log_faults/declared_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Of readings of a current that a machine of one's own has, whose sensor the machine file gives a range of 50 mA.
std::vector<std::string> OfCurrent(const std::string& unit, const std::vector<double>& readings,
                                   std::vector<Quality> flags = {}) {
  Machine machine;
  machine.model = "states";
  machine.signals.push_back({.name = "current", .column = "i", .unit = unit, .min = -0.05, .max = 0.05});
  SampleBlock rows;
  for (std::size_t k = 0; k < readings.size(); ++k) rows.time.push_back(static_cast<double>(k));
  rows.signal = {readings};
  flags.resize(readings.size(), 0);
  rows.quality = {flags};
  DeclaredRanges ranges(machine);
  ranges.Observe(rows);
  return InEnglish(ranges.Sentences());
}

TEST(DeclaredRange, ReadingsThatFillAThousandthOfItOrAThousandOfThemAreInAnotherUnit) {
  EXPECT_THAT(OfCurrent("mA", {-0.02, 0.02}), IsEmpty());
  EXPECT_THAT(OfCurrent("mA", {-0.001, 0.001}), IsEmpty()) << "it is hardly used";
  EXPECT_THAT(OfCurrent("mA", {-2e-5, 2e-5}), ElementsAre(HasSubstr("They look like A: set unit = \"A\"")));
  EXPECT_THAT(OfCurrent("A", {-20, 20}), ElementsAre(HasSubstr("They look like mA: set unit = \"mA\"")));
}

TEST(DeclaredRange, ASpikeIsNoReading) {
  EXPECT_THAT(OfCurrent("A", {-0.02, 20, 0.02}, {0, quality::kSpike, 0}), IsEmpty());
  EXPECT_THAT(OfCurrent("A", {-0.02, 20, 0.02}), testing::SizeIs(1));
}

TEST(DeclaredRange, OfASignalThatLiesOutsideOfItForMoreThanMomentsItIsSaid) {
  Machine machine = *LoadMachine(HYDROSCOPE_SOURCE_DIR "/machines/die_cushion.toml");
  const auto said = [&](double pressure, double outside, int rows_outside) {
    SampleBlock rows;
    rows.Resize(machine.signals.size(), 1000);
    for (double& oil : rows.signal[static_cast<std::size_t>(machine.SignalIndex("T_oil"))]) oil = 313;
    auto& p_B = rows.signal[static_cast<std::size_t>(machine.SignalIndex("p_B"))];
    for (std::size_t k = 0; k < rows.rows(); ++k)
      p_B[k] = k < static_cast<std::size_t>(rows_outside) ? outside : pressure + static_cast<double>(k % 7);
    DeclaredRanges ranges(machine);
    ranges.Observe(rows);
    return InEnglish(ranges.Sentences());
  };
  EXPECT_THAT(said(60e5, 0, 0), IsEmpty());
  EXPECT_THAT(said(60e5, -62e5, 30), IsEmpty()) << "a wire that was broken for a moment";
  EXPECT_THAT(said(60e5, 700e5, 200),
              ElementsAre(testing::AllOf(HasSubstr("p_B (column p_B): 20 % of the readings lie outside"),
                                         testing::Not(HasSubstr("scale = -1")))));
  EXPECT_THAT(said(-60e5, 0, 0), ElementsAre(HasSubstr("set scale = -1")));
}

}  // namespace
}  // namespace hydroscope
