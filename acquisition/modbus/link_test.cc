#include "acquisition/modbus/link.h"

#include <gtest/gtest.h>

namespace hydroscope {
namespace {

TEST(ModbusLink, TellsANameThatNobodyKnowsFromAPortThatNobodyListensOn) {
  ModbusLink unknown("press.invalid", 502, 1, 0.2);  // RFC 6761: never resolves
  EXPECT_EQ(unknown.Connect(), LinkOutcome::kBroken);
  EXPECT_NE(unknown.problem().english.find("nobody knows a computer of this name"), std::string::npos)
      << unknown.problem().english;
  ModbusLink closed("127.0.0.1", 1, 1, 0.2);
  EXPECT_EQ(closed.Connect(), LinkOutcome::kBroken);
  EXPECT_NE(closed.problem().english.find("refused"), std::string::npos) << closed.problem().english;
}

}  // namespace
}  // namespace hydroscope
