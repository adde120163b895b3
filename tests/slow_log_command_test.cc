#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;
using testing::Not;

/// A log whose rows are too far apart carries no verdict, whichever way it comes.
class SlowLog : public CommandLine {
 protected:
  /// Every `every`-th row of a log.
  std::string Thinned(const std::string& log, int every) {
    std::istringstream in(ReadText(log));
    std::ostringstream out;
    std::string line;
    for (int row = -1; std::getline(in, line); ++row)
      if (row < 0 || row % every == 0) out << line << '\n';
    WriteText(File("slow.csv"), out.str());
    return File("slow.csv");
  }
  std::string Leaking() {
    return Thinned(Simulate("leak.csv", 120, 4, {"--effect", "internal_leakage=4e-12"}), 50);
  }
};

TEST_F(SlowLog, GivesNoVerdictAsALog) {
  const std::string log = Leaking();
  for (const std::string command : {"check", "fit", "compare", "explain"}) {
    const Ran ran = Run({command, log, "-m", kMachine});
    EXPECT_THAT(ran.out, HasSubstr("sampled too slowly")) << command;
    EXPECT_THAT(ran.out, Not(HasSubstr("ADEQUATE"))) << command;
    EXPECT_THAT(ran.out, Not(HasSubstr("describes these strokes"))) << command;
  }
}

TEST_F(SlowLog, GivesNoVerdictFromTheDatabaseAndIsNotLearned) {
  const std::string log = Leaking(), db = File("slow.db");
  ASSERT_EQ(Run({"replay", log, "-m", kMachine, "--db", db}).exit_code, 0);
  for (const std::string command : {"compare", "explain"}) {
    const Ran ran = Run({command, "--db", db});
    EXPECT_THAT(ran.out, HasSubstr("sampled too slowly")) << command << ran.err;
    EXPECT_THAT(ran.out, Not(HasSubstr("ADEQUATE"))) << command;
    EXPECT_THAT(ran.out, Not(HasSubstr("describes these strokes"))) << command;
  }
  const Ran learn = Run({"learn", "--db", db, "--json", "-"});
  EXPECT_NE(learn.exit_code, 0);
  EXPECT_EQ(learn.Json()["refused"][0]["doubts"][0]["kind"], "too_slow") << learn.out;
}

}  // namespace
}  // namespace hydroscope
