// Logs of one machine from loggers whose rates differ a little are one history.

#include <cmath>
#include <random>

#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

const char* const kSpring = R"toml(
[machine]
name = "spring"
[log]
time = { column = "t", unit = "s" }
[signals]
x = { column = "x", unit = "m" }
r = { column = "r", unit = "bar/s" }
F = { column = "F", unit = "N" }
[gate]
max_stroke = 5
[window]
block = 0.05
span = 1
half_width = 0.1
[balance]
output = "F"
unit = "N"
terms = { k = "x", c = "r" }
)toml";
constexpr double kStiffness = 4000, kPerRate = 2e-6;  // N/m, N per Pa/s

class SimilarRates : public CommandLine {
 protected:
  std::string Log(const std::string& name, double period, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise;
    std::ofstream out(File(name));
    out << "t,x,r,F\n";
    for (int row = 0; row * period < 60; ++row) {
      const double t = row * period;
      const double x = 0.05 * std::sin(0.9 * t) + 0.02 * std::sin(2.3 * t), r = 3 * std::cos(1.7 * t);
      out << t << ',' << x << ',' << r << ',' << kStiffness * x + kPerRate * 1e5 * r + noise(random) << '\n';
    }
    return File(name);
  }
  void SetUp() override {
    CommandLine::SetUp();
    WriteText(File("spring.toml"), kSpring);
  }
};

TEST_F(SimilarRates, AreInterpolatedWithANote) {
  const std::string a = Log("a.csv", 0.0102, 1), b = Log("b.csv", 0.0118, 2);
  const Ran fit = Run({"fit", a, b, "-m", File("spring.toml")});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_THAT(fit.out, HasSubstr("rows 11.8 ms apart are interpolated to 10.2 ms"));
  const auto json = Run({"fit", a, b, "-m", File("spring.toml"), "--json", "-"}).Json();
  EXPECT_GE(json["strokes"], 20) << "a log without conditions is cut into episodes of 5 s";
  for (const auto& [name, truth] : {std::pair{"k", kStiffness}, {"c", kPerRate}}) {
    const auto& parameter = json["parameters"][name];
    EXPECT_NEAR(parameter["value"].get<double>(), truth, 4 * parameter["std"].get<double>()) << name;
  }
}

TEST_F(SimilarRates, AreOneHistoryInADatabase) {
  const std::string a = Log("a.csv", 0.0102, 1), b = Log("b.csv", 0.0118, 2);
  const Ran replay = Run({"replay", a, b, "-m", File("spring.toml"), "--db", File("s.db")});
  EXPECT_EQ(replay.exit_code, 0) << replay.err << replay.out;
  EXPECT_THAT(replay.out, HasSubstr("interpolated to 10.2 ms"));
  const auto logs =
      Run({"replay", a, b, "-m", File("spring.toml"), "--db", File("counted.db"), "--json", "-"})
          .Json()["logs"];
  ASSERT_EQ(logs.size(), 2U);
  EXPECT_LE(logs[1]["used_rows"], logs[1]["rows"]) << "of the rows that were interpolated";
  EXPECT_EQ(Run({"explain", "--db", File("s.db")}).exit_code, 0);
}

TEST_F(SimilarRates, FarApartAreRefused) {
  const Ran fit = Run({"fit", Log("a.csv", 0.0102, 1), Log("b.csv", 0.0202, 2), "-m", File("spring.toml")});
  EXPECT_EQ(fit.exit_code, 3);
  EXPECT_THAT(fit.err, HasSubstr("nearly the same sampling rate"));
}

}  // namespace
}  // namespace hydroscope
