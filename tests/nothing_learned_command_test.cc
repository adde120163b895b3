// Logs from which nothing can be learned: what `replay`, `fit` and `check` say of them.

#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class NothingLearned : public CommandLine {
 protected:
  /// A log of the press whose spool reading is one and the same throughout.
  std::string Stuck(const std::string& name) {
    std::istringstream good(ReadText(Simulate("good.csv", 90, 1)));
    std::string text, line, field;
    std::size_t column = 0;
    for (bool header = true; std::getline(good, line); header = false) {
      std::istringstream fields(line);
      std::string row;
      for (std::size_t k = 0; std::getline(fields, field, ','); ++k) {
        if (header && field.starts_with("y_v")) column = k;
        row += (k > 0 ? "," : "") + (!header && k == column ? "0.3" : field);
      }
      text += row + "\n";
    }
    WriteText(File(name), text);
    return File(name);
  }
  Ran Replay(const std::vector<std::string>& logs, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"replay", "-m", kMachine, "--db", File("a.db")};
    words.insert(words.end(), logs.begin(), logs.end());
    words.insert(words.end(), more.begin(), more.end());
    return Run(words);
  }
};

TEST_F(NothingLearned, AReplayThatIdentifiesNothingIsPartlyDone) {
  const std::string log = Stuck("stuck.csv");
  const Ran ran = Replay({log}, {"--json", "-"});
  EXPECT_EQ(ran.exit_code, 4) << ran.out;
  const nlohmann::json json = ran.Json();
  EXPECT_EQ(json["complete"], false);
  EXPECT_TRUE(json["rms_holdout"].is_null());
  EXPECT_TRUE(json["noise_floor"].is_null());
  EXPECT_THAT(json["logs"][0]["taught_nothing"].get<std::string>(), HasSubstr("y_v (column y_v)"));
  const Ran again = Replay({log});
  EXPECT_EQ(again.exit_code, 4) << again.out;
  EXPECT_THAT(again.out, HasSubstr("NOTHING LEARNED"));
}

// A night in which the machine stood still but for a stroke or two.
TEST_F(NothingLearned, AFewStrokesAfterLogsThatTaughtAreNoFault) {
  const std::string full = Simulate("full.csv", 60, 1), night = Simulate("night.csv", 8, 2);
  const Ran ran = Replay({full, night}, {"--json", "-"});
  EXPECT_EQ(ran.exit_code, 0) << ran.out;
  EXPECT_TRUE(ran.Json()["logs"][1]["taught_nothing"].is_null());
  EXPECT_EQ(Replay({Stuck("stuck.csv")}).exit_code, 4)
      << "strokes enough for a fit, and none told of a parameter";
}

TEST_F(NothingLearned, TheSensorThatStandsStillIsNamedAndNoOtherWayOfDriving) {
  const std::string log = Stuck("stuck.csv");
  const Ran fit = Run({"fit", log, "-m", kMachine});
  EXPECT_EQ(fit.exit_code, 3);
  EXPECT_THAT(fit.err,
              AllOf(HasSubstr("y_v (column y_v): one and the same reading"), Not(HasSubstr("vary"))));
  const Ran check = Run({"check", log, "-m", kMachine, "--json", "-"});
  EXPECT_EQ(check.exit_code, 4);
  const nlohmann::json k = check.Json()["parameters"]["K"];
  EXPECT_THAT(k["why"].get<std::string>(), HasSubstr("one and the same reading"));
  EXPECT_THAT(k["advice"].get<std::string>(), Not(HasSubstr("vary")));
}

}  // namespace
}  // namespace hydroscope
