#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::ContainsRegex;
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

/// So does one whose position is read from a counter that overflows.
TEST_F(SlowLog, WithAPositionThatJumpsGivesNoneEither) {
  std::istringstream in(ReadText(Simulate("press.csv", 60, 4)));
  std::ostringstream out;
  std::string line;
  std::getline(in, line);
  out << line << '\n';
  const auto column =
      std::count(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(line.find(",z,")) + 1, ',');
  for (std::string field; std::getline(in, line); out << '\n') {
    std::istringstream fields(line);
    for (std::ptrdiff_t k = 0; std::getline(fields, field, ','); ++k)
      out << (k > 0 ? "," : "")
          << (k == column ? fmt::format("{:.7f}", std::fmod(std::stod(field) + 1, 0.065536)) : field);
  }
  const std::string log = File("jumps.csv"), db = File("jumps.db");
  WriteText(log, out.str());
  for (const std::string command : {"fit", "compare", "explain"}) {
    const Ran ran = Run({command, log, "-m", kMachine});
    EXPECT_NE(ran.exit_code, 0) << command;
    EXPECT_THAT(ran.err, HasSubstr("a counter that overflows")) << command;
  }
  const Ran check = Run({"check", log, "-m", kMachine});
  EXPECT_NE(check.exit_code, 0);
  EXPECT_THAT(check.out, HasSubstr("a counter that overflows"));
  EXPECT_THAT(check.out, HasSubstr("mend what stands below"));
  ASSERT_EQ(Run({"replay", log, "-m", kMachine, "--db", db}).exit_code, 0);
  EXPECT_THAT(Run({"explain", "--db", db}).out, HasSubstr("a counter that overflows"));
  EXPECT_EQ(Run({"learn", "--db", db, "--json", "-"}).Json()["refused"][0]["doubts"][0]["kind"],
            "implausible");
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
  const std::string page = File("slow.html");
  ASSERT_EQ(Run({"report", "--db", db, "--out", page}).exit_code, 0);
  EXPECT_THAT(ReadText(page), AllOf(HasSubstr("The model cannot be judged on these strokes: run 1"),
                                    ContainsRegex("Why: run 1 .*: sampled too slowly"),
                                    Not(HasSubstr("about down to what sensor noise leaves"))));
  const Ran learn = Run({"learn", "--db", db, "--json", "-"});
  EXPECT_NE(learn.exit_code, 0);
  EXPECT_EQ(learn.Json()["refused"][0]["doubts"][0]["kind"], "too_slow") << learn.out;
}

/// As many strokes as the healthy machine is learned from: the log is replayed all the same, and nothing is learned.
TEST_F(SlowLog, OfAllOfCommissioningIsReplayedAndNotLearned) {
  const std::string log = Thinned(Simulate("long.csv", 760, 4), 50), machine = File("slow.toml"),
                    db = File("slow.db");
  WriteText(machine, ReadText(kMachine));
  const std::string rules = ReadText(std::string(HYDROSCOPE_SOURCE_DIR) + "/machines/die_cushion_rules.toml");
  WriteText(File("slow_rules.toml"),
            std::regex_replace(rules, std::regex("commissioning = \\d+"), "commissioning = 100"));
  const Ran ran = Run({"replay", log, "-m", machine, "--db", db});
  ASSERT_EQ(ran.exit_code, 4) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("NOTHING LEARNED"));
  EXPECT_THAT(ran.out, HasSubstr("Drift is not watched: nothing is learned from strokes 0 to 99"));
  EXPECT_THAT(ran.out, HasSubstr("sampled too slowly"));
}

}  // namespace
}  // namespace hydroscope
