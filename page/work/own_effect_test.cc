#include "page/work/own_effect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "models/machine.h"
#include "page/work/own_draft.h"

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

TEST(OwnEffect, TheOutputOfABalanceThatIsBeingWrittenIsRefusedAtItsPlace) {
  const auto machine = ParseMachine(SealFile(), "seal.toml");
  ASSERT_TRUE(machine);
  OwnDraft draft;
  draft.Take(*machine);
  const auto look = [&](const std::string& expression, const std::string& output) {
    const auto course = draft.Look({"term", expression, "", false, false, output});
    return course ? Error{} : course.error();
  };
  EXPECT_EQ(look("1*p + p", "p").text,
            "p is the output itself, and would explain all of it\n    1*p + p\n      ^");
  EXPECT_THAT(look("1*p + p", "p").german, HasSubstr("p ist der Ausgang selbst"));
  EXPECT_THAT(look("x + p", "p").text,
              testing::AllOf(HasSubstr("puts m and Pa together"), HasSubstr("\np is the output itself")))
      << "of two problems both, without their places in the file";
  EXPECT_EQ(look("ddt(p)", "p").text, "");
  EXPECT_EQ(look("p", "x").text, "");
  EXPECT_EQ(look("p", "2*p").text, "") << "of a product any term may read it";
  EXPECT_EQ(look("p", "nothing").text, "");
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
