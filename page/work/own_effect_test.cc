#include "page/work/own_effect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "models/machine.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

std::string SealFile() {
  std::ifstream file(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/seal_friction.toml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string ProblemOf(const std::string& expression) {
  const auto text = WithOwnEffect(SealFile(), {"own", expression, "", true, false});
  return text ? "" : text.error().text;
}

TEST(OwnEffect, JoinsTheLibraryOfTheMachine) {
  const auto text = WithOwnEffect(SealFile(), {"own_drag", "ddt(x)", "N s/m", true, true});
  ASSERT_TRUE(text) << text.error().text;
  const auto machine = ParseMachine(*text, "seal.toml");
  ASSERT_TRUE(machine);
  EXPECT_EQ(machine->user_effects.back().id, "own_drag");
  EXPECT_EQ(machine->user_effects.back().min, 0.0);
}

TEST(OwnEffect, MarksThePlaceOfWhatIsWrong) {
  EXPECT_THAT(ProblemOf("p*foo"), HasSubstr("unknown signal \"foo\""));
  EXPECT_THAT(ProblemOf("p*foo"), HasSubstr("p*foo\n      ^"));
  EXPECT_THAT(ProblemOf("p*(p+x)"), HasSubstr("puts Pa and m together"));
  EXPECT_THAT(ProblemOf("p*sin(x"), HasSubstr("ends here"));
  EXPECT_EQ(ProblemOf("p*foo").find("seal"), std::string::npos);
  EXPECT_EQ(ProblemOf("p*sign(ddt(x))"), "");
}

TEST(OwnEffect, RefusesAnIdThatIsThereAlready) {
  EXPECT_FALSE(WithOwnEffect(SealFile(), {"coulomb_friction", "sign(ddt(x))", "", true, false}));
}

TEST(OwnEffect, TakesNothingThatLeavesItsQuotes) {
  EXPECT_TRUE(ParseOwnEffect(R"({"id": "a", "expression": "p"})"));
  for (const char* body :
       {R"({"id": "a", "expression": "p\" }\n[machine]"})", R"({"id": "a\"", "expression": "p"})",
        R"({"id": "a", "expression": "p\\"})", R"({"id": "a", "expression": "p\nq"})",
        R"({"id": "a", "expression": "  "})", R"({"id": "a", "expression": 3})",
        R"({"id": "1", "expression": "p"})", R"({"id": "a", "expression": "p", "unit": "m\""})",
        R"({"id": "a", "expression": "p", "keep": 1})", "[]"})
    EXPECT_FALSE(ParseOwnEffect(body)) << body;
}

}  // namespace
}  // namespace hydroscope
