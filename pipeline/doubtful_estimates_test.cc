#include "pipeline/doubtful_estimates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hydroscope {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> Doubts(const std::string& file, const std::vector<Estimate>& estimates) {
  const auto machine = LoadMachine(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/" + file);
  EXPECT_TRUE(machine) << (machine ? "" : machine.error().text);
  return InEnglish(DoubtsOf(machine.value_or(Machine{}), estimates));
}

std::vector<Estimate> OfTestCylinder(double gain) {
  return {{"f_h", 343, 1, "Hz"},
          {"zeta_h", 1, 0.01, "1"},
          {"f_sv", 160, 1, "Hz"},
          {"K_sv", gain, 1e-5, "m3/(s A)"},
          {"T_d", 0, 1e-6, "s"}};
}

TEST(DoubtfulEstimates, AGainOfTheOtherSignIsAReversedSignal) {
  EXPECT_THAT(Doubts("test_cylinder.toml", OfTestCylinder(0.0114)), IsEmpty());
  EXPECT_THAT(Doubts("test_cylinder.toml", OfTestCylinder(-0.0114)),
              ElementsAre(testing::HasSubstr("z or I_v is reversed")));
}

TEST(DoubtfulEstimates, ABulkModulusThatNoOilHasIsOne) {
  const auto of = [](double modulus) {
    return Doubts("die_cushion.toml", {{"K", modulus, 0.01 * modulus, "Pa"}});
  };
  EXPECT_THAT(of(1.2e9), IsEmpty());
  EXPECT_THAT(of(1.2e12), ElementsAre(testing::HasSubstr("K comes out as")));
}

}  // namespace
}  // namespace hydroscope
