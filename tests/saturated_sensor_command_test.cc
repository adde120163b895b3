// Logs of a pressure sensor that ends below the pressures of the machine.

#include <random>
#include <sstream>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class SaturatedSensor : public CommandLine {
 protected:
  /// A simulated log whose p_A never reads above `limit`, but for noise that comes from behind it; Pa.
  std::string CutOff(double limit, double noise_behind) {
    std::istringstream lines(ReadText(Simulate("whole.csv", 60, 3)));
    std::mt19937_64 random(1);
    std::normal_distribution<double> noise(0, noise_behind);
    std::string text, line;
    std::getline(lines, line);
    text = line + "\n";
    while (std::getline(lines, line)) {
      const std::size_t begin = line.find(',') + 1, end = line.find(',', begin);
      const double pressure = std::stod(line.substr(begin, end - begin));
      if (pressure > limit) {
        const double read = noise_behind > 0 ? limit + noise(random) : limit;
        line.replace(begin, end - begin, std::to_string(static_cast<long>(read)));
      }
      text += line + "\n";
    }
    WriteText(File("cut.csv"), text);
    return File("cut.csv");
  }
  std::string OneLine(const std::string& text) {
    std::string out;
    for (const char c : text)
      if (c != '\n' && c != ' ')
        out += c;
      else if (!out.ends_with(' '))
        out += ' ';
    return out;
  }
};

TEST_F(SaturatedSensor, IsNoLossOfOil) {
  for (const double noise_behind : {0.0, 5e3}) {
    const std::string log = CutOff(110e5, noise_behind);
    const std::string said = OneLine(Run({"explain", log, "-m", kMachine}).out);
    EXPECT_THAT(said, AllOf(HasSubstr("ADEQUATE"), HasSubstr("saturat"), Not(HasSubstr("is lost"))))
        << noise_behind;
    EXPECT_THAT(said, Not(HasSubstr("NOT ALL STROKES")))
        << "the readings before the limit is known count as well";
    const std::string checked = OneLine(Run({"check", log, "-m", kMachine}).out);
    EXPECT_THAT(checked, AllOf(HasSubstr("saturat"), HasSubstr("out_of_range"))) << noise_behind;
    const Ran replayed = Run({"replay", log, "-m", kMachine, "--db", File("cut.db")});
    EXPECT_THAT(OneLine(replayed.out), HasSubstr("saturat")) << noise_behind;
    EXPECT_THAT(OneLine(Run({"explain", "--db", File("cut.db")}).out), HasSubstr("ADEQUATE"))
        << noise_behind << ": replayed without these readings, as the log is explained";
    std::filesystem::remove(File("cut.db"));
  }
}

}  // namespace
}  // namespace hydroscope
