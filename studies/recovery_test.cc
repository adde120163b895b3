#include "studies/recovery.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

/// How far the size found lies from the truth, standard deviations, of a random machine.
double DeviationOf(const std::string& effect, std::uint64_t seed) {
  const auto values = RecoverEffect(effect, 120, seed, true);
  return values && !values->empty() ? std::abs(values->front().Deviation())
                                    : std::numeric_limits<double>::infinity();
}

TEST(Recovery, WhatTheSpoolDidBetweenSamplesIsInTheIntervalOfItsPlay) {
  EXPECT_LT(DeviationOf("spool_hysteresis", 7010010), 2);
}

TEST(Recovery, NoRestBendsALawOfTheNullHoweverShortTheMachinesWay) {
  EXPECT_LT(DeviationOf("valve_flow_asymmetry", 7002008), 2);
  EXPECT_LT(DeviationOf("spool_overlap", 7003009), 2);
}

}  // namespace
}  // namespace hydroscope
