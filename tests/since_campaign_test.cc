// Short form of `hydroscope benchmark since`: replayed logs of machines before and after something changed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

TEST_F(CommandLine, WhatDidNotChangeIsNotNamed) {
  const Ran ran = Run({"benchmark", "since", "--cases", "10", "--seed", "12"});
  EXPECT_THAT(ran.out, HasSubstr("named though it did not change: 0 of 7")) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("0 of 3 without"));
}

TEST_F(CommandLine, AHistoryOfAnEffectThatTheSimulatorDoesNotKnowIsRefused) {
  EXPECT_EQ(Run({"benchmark", "since", "--effect", "relief"}).exit_code, 2);
}

}  // namespace
}  // namespace hydroscope
