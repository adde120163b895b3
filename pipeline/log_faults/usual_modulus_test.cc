#include "pipeline/log_faults/usual_modulus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace hydroscope {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Machine PlainCushion() {
  Machine machine;
  machine.model = "die_cushion";
  return machine;
}
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
  EXPECT_EQ(UnusualParameters(PlainCushion(), parameters).size(), 2u);
}

TEST(UsualParameters, AFlowFarFromTheDataSheetOfTheValveIsSaid) {
  Machine machine = PlainCushion();
  const auto said = [&](double flow) {
    return UnlikeDataSheet(machine, OfValue("Q_vn", "m3/s", flow)).english;
  };
  EXPECT_EQ(said(1.7e-3), "") << "nothing is stated";
  machine.geometry["Q_nom"] = {1.7e-3, 0};
  for (const double flow : {1.7e-3, 1.4e-3, 2.1e-3}) EXPECT_EQ(said(flow), "") << flow;
  for (const double flow : {1.7e-3 / std::numbers::sqrt2, 1.7e-3 * std::numbers::sqrt2, 1.7e-2})
    EXPECT_THAT(said(flow), HasSubstr("where Q_nom = 102 l/min in the machine file")) << flow;
  EXPECT_EQ(UnlikeDataSheet(machine, OfValue("V0", "m3", 0.17)).english, "");
}

}  // namespace
}  // namespace hydroscope
