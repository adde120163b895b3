// The maintenance report of a database that something else may be writing.

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

class StoredReportCommand : public CommandLine {};

TEST_F(StoredReportCommand, ShowsWhatTheDatabaseHolds) {
  const std::string log = Simulate("press.csv", 60, 1);
  ASSERT_EQ(Run({"replay", log, "-m", kMachine, "--db", File("press.db")}).exit_code, 0);
  const Ran ran = Run({"report", "--db", File("press.db"), "--out", File("press.html"), "--json", "-"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  EXPECT_EQ(ran.Json()["strokes"], 11);
  const std::string page = ReadText(File("press.html"));
  for (const char* text : {"<html", "effective bulk modulus", "dead volume", "</html>"})
    EXPECT_THAT(page, HasSubstr(text));
}

TEST_F(StoredReportCommand, OfNoDatabaseIsAnErrorThatSaysSo) {
  const Ran ran = Run({"report", "--db", File("no.db"), "--out", File("no.html")});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, HasSubstr("no.db"));
  EXPECT_FALSE(std::filesystem::exists(File("no.html")));
}

}  // namespace
}  // namespace hydroscope
