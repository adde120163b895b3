#include <regex>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;
using testing::Not;

/// A machine file that has the column of one pressure for another: no command says that all is well.
class SwappedColumns : public CommandLine {
 protected:
  std::string WithColumns(const std::string& p_b, const std::string& p_0) {
    const std::string text = ReadText(kMachine);
    std::string changed = std::regex_replace(text, std::regex("column = \"p_B\""), "column = \"@\"");
    changed = std::regex_replace(changed, std::regex("column = \"p_0\""), "column = \"" + p_0 + "\"");
    WriteText(File("swapped.toml"), std::regex_replace(changed, std::regex("\"@\""), "\"" + p_b + "\""));
    return File("swapped.toml");
  }
  static void ExpectNoAllClear(const Ran& ran, const std::string& command, const std::string& why) {
    const std::string out = std::regex_replace(ran.out, std::regex("\\s+"), " ");  // lines are broken
    EXPECT_THAT(out, HasSubstr(why)) << command << ran.err;
    EXPECT_THAT(out, Not(HasSubstr("ADEQUATE"))) << command;
    EXPECT_THAT(out, Not(HasSubstr("describes these strokes"))) << command;
  }
  void ExpectNoAllClear(const std::string& machine, const std::string& why) {
    const std::string log = Simulate("healthy.csv", 60, 3), db = File("swapped.db");
    for (const std::string command : {"check", "fit", "compare", "explain"})
      ExpectNoAllClear(Run({command, log, "-m", machine}), command, why);
    EXPECT_THAT(Run({"check", log, "-m", machine}).out, HasSubstr("mend what stands below"));
    const auto json = Run({"explain", log, "-m", machine, "--json", "-"}).Json();
    EXPECT_EQ(json["verdict"], "unknown");
    ASSERT_EQ(Run({"replay", log, "-m", machine, "--db", db}).exit_code, 0);
    for (const std::string command : {"compare", "explain"})
      ExpectNoAllClear(Run({command, "--db", db}), command, why);
    EXPECT_EQ(Run({"learn", "--db", db, "--json", "-"}).Json()["refused"][0]["doubts"][0]["kind"],
              "implausible");
  }
};

TEST_F(SwappedColumns, OfTheSupplyAndAChamberLeaveNoAllClear) {
  ExpectNoAllClear(WithColumns("p_0", "p_B"), "the two columns are");
}

TEST_F(SwappedColumns, AWorkingPressureInPlaceOfTheSupplysLeavesNone) {
  ExpectNoAllClear(WithColumns("p_B", "p_A"), "p_A (column p_A) and p_0 (column p_A) have the same reading");
}

/// A position that is turned round, gate and all, leaves a model that fits as well, with a valve that lets oil in as it opens.
TEST_F(SwappedColumns, ParametersThatPhysicsForbidsLeaveNone) {
  const std::string text = ReadText(kMachine);
  std::string turned = std::regex_replace(text, std::regex("(column = \"z\",)"), "$1 scale = -1,");
  turned = std::regex_replace(turned, std::regex("(\"ddt\\(z\\)\" = \\{ )max = -"), "$1min = ");
  ASSERT_NE(turned, text);
  WriteText(File("turned.toml"), turned);
  const std::string log = Simulate("healthy.csv", 60, 3), db = File("turned.db");
  for (const std::string command : {"check", "fit", "compare", "explain"})
    ExpectNoAllClear(Run({command, log, "-m", File("turned.toml")}), command, "physics");
  ASSERT_EQ(Run({"replay", log, "-m", File("turned.toml"), "--db", db}).exit_code, 0);
  for (const std::string command : {"compare", "explain"})
    ExpectNoAllClear(Run({command, "--db", db}), command, "physics");
}

}  // namespace
}  // namespace hydroscope
