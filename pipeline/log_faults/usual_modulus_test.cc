#include "pipeline/log_faults/usual_modulus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const MachineKind& CushionKind() { return *FindKind("die_cushion"); }

Estimate OfValue(const char* parameter, const char* unit, double value) {
  Estimate e;
  e.parameter = parameter;
  e.unit = unit;
  e.value = value;
  e.std = 0.01 * value;
  e.reason = EstimateReason::kUpdated;
  return e;
}

TEST(UsualParameters, AFlowThatNoValvePassesIsAWrongUnit) {
  EXPECT_TRUE(ImpossibleFlow(CushionKind(), OfValue("Q_vn", "m3/s", 1.7e-3)).empty());
  const Told told = ImpossibleFlow(CushionKind(), OfValue("Q_vn", "m3/s", 0.17));
  EXPECT_THAT(told.english, AllOf(HasSubstr("Q_vn comes out as 10200 l/min"), HasSubstr("(1 or %)")));
  EXPECT_THAT(told.german, HasSubstr("(1 oder %)"));
  EXPECT_TRUE(ImpossibleFlow(CushionKind(), OfValue("V0", "m3", 0.17)).empty());
}

TEST(UsualParameters, AreSaidOfAll) {
  const std::vector<Estimate> parameters = {OfValue("K", "Pa", 1.2e8), OfValue("Q_vn", "m3/s", 0.17),
                                            OfValue("V0", "m3", 1e-3)};
  EXPECT_EQ(UnusualParameters(CushionKind(), parameters).size(), 2u);
}

}  // namespace
}  // namespace hydroscope
