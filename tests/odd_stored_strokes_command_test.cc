// A few strokes that differ from the rest are told of a log and of a database alike.

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;

using OddStoredStrokes = CommandLine;

/// In one stroke the pressure reads 25 bar too much.
TEST_F(OddStoredStrokes, AreToldOfADatabaseAsOfItsLog) {
  std::istringstream lines(ReadText(Simulate("whole.csv", 60, 3)));
  std::string text, line;
  std::getline(lines, line);
  text = line + "\n";
  while (std::getline(lines, line)) {
    const std::size_t begin = line.find(',') + 1, end = line.find(',', begin);
    const double t = std::stod(line);
    if (t > 20 && t < 27)
      line.replace(begin, end - begin,
                   std::to_string(static_cast<long>(1.3 * std::stod(line.substr(begin)))));
    text += line + "\n";
  }
  WriteText(File("odd.csv"), text);
  Run({"compare", File("odd.csv"), "-m", kMachine, "--json", File("log.json"), "--quiet"});
  ASSERT_EQ(Run({"replay", File("odd.csv"), "-m", kMachine, "--db", File("odd.db"), "--quiet"}).exit_code, 0);
  const Ran ran = Run({"compare", "--db", File("odd.db"), "--json", File("db.json")});
  const auto of_log = nlohmann::json::parse(ReadText(File("log.json")));
  const auto of_db = nlohmann::json::parse(ReadText(File("db.json")));
  ASSERT_FALSE(of_log["odd_strokes"].empty());
  ASSERT_FALSE(of_db["odd_strokes"].empty()) << ran.out;
  EXPECT_EQ(of_db["odd_strokes"][0]["strokes"], of_log["odd_strokes"][0]["strokes"]);
  EXPECT_EQ(of_db["strokes_described"], of_log["strokes_described"]);
  EXPECT_EQ(of_db["verdict"], of_log["verdict"]);
  const auto explained = Run({"explain", "--db", File("odd.db"), "--json", "-"});
  EXPECT_EQ(nlohmann::json::parse(explained.out)["verdict"], of_db["verdict"]);
}

/// A leak that came and went again divides the strokes nowhere.
TEST_F(OddStoredStrokes, AStretchThatDiffersIsToldByCompare) {
  const std::string before = Simulate("before.csv", 60, 1),
                    leaks = Simulate("leaks.csv", 60, 2, {"--effect", "internal_leakage=1e-11"}),
                    after = Simulate("after.csv", 60, 3);
  ASSERT_EQ(
      Run({"replay", before, leaks, after, "-m", kMachine, "--db", File("came.db"), "--quiet"}).exit_code, 0);
  const auto compared = Run({"compare", "--db", File("came.db"), "--json", "-"}).Json();
  EXPECT_THAT(compared.at("warnings").dump(), testing::HasSubstr("hold a stretch that differs"));
  EXPECT_THAT(compared.at("warnings").dump(), testing::Not(testing::HasSubstr("y_0")))
      << "a leak, as `explain` says, and no other spool";
}

}  // namespace
}  // namespace hydroscope
