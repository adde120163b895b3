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

}  // namespace
}  // namespace hydroscope
