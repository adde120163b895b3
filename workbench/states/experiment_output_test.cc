#include "workbench/states/experiment_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/machine.h"

namespace hydroscope {
namespace {

StatesExplained OfPump(Verdict verdict, std::vector<std::string> nearest) {
  StatesExplained e;
  e.log.machine = LoadMachine(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/pump.toml").value();
  e.explanation.verdict = verdict;
  e.explanation.nearest = std::move(nearest);
  return e;
}

TEST(StatesToRecord, WhatShowsAnEffectThatOnlyExplainsAPart) {
  const auto told = StatesToRecord(OfPump(Verdict::kUnknown, {"leakage_grown", "sticking_spool"}));
  ASSERT_TRUE(told);
  EXPECT_THAT(told->english, testing::StartsWith("To test sticking_spool, record a log with the shaft at"));
  EXPECT_THAT(told->german, testing::HasSubstr("Drehzahl"));
}

TEST(StatesToRecord, NothingOfEffectsThatAreNamedOrThatShowInAnyRecord) {
  EXPECT_FALSE(StatesToRecord(OfPump(Verdict::kNamed, {"sticking_spool"})));
  EXPECT_FALSE(StatesToRecord(OfPump(Verdict::kUnknown, {"leakage_grown"})));
}

}  // namespace
}  // namespace hydroscope
