#include "studies/recovery.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulator/die_cushion/effects.h"

namespace hydroscope {
namespace {

std::vector<std::string> AllEffects() {
  std::vector<std::string> ids;
  for (const EffectInfo& effect : PressEffects()) ids.push_back(effect.id);
  return ids;
}

class EveryEffect : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(OfTheLibrary, EveryEffect, testing::ValuesIn(AllEffects()));

TEST_P(EveryEffect, IsRecoveredWithinThreeStandardDeviationsAndTheBaseParametersToo) {
  const auto values = RecoverEffect(GetParam(), 60, 77);
  ASSERT_TRUE(values) << values.error().text;
  ASSERT_GE(values->size(), 5u);
  for (const RecoveredValue& value : *values) {
    EXPECT_TRUE(std::isfinite(value.std) && value.std > 0) << value.name;
    EXPECT_LE(std::abs(value.value - value.truth), 3 * value.std)
        << value.name << " " << value.value << " +- " << value.std << ", truth " << value.truth;
  }
}

}  // namespace
}  // namespace hydroscope
