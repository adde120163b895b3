#include "diagnosis/states/general_laws.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "diagnosis/states/explain_states.h"
#include "models/machine.h"

namespace hydroscope {
namespace {

/// Two tanks in a row, the first leaks and is not measured; the file knows a leak of the second alone.
TEST(GeneralLaws, AreAskedInTheEquationThatWhatIsLeftPointsTo) {
  const auto machine = ParseMachine(R"toml([log]
hold = "zero"
[signals]
u = { column = "u", unit = "V" }
y = { column = "y", unit = "V" }
[states]
h_1 = { ddt = "pump*u - k1*sqrt(max(h_1, 0))", initial = "estimate", min = 0 }
h_2 = { ddt = "k1*sqrt(max(h_1, 0)) - k2*sqrt(max(h_2, 0))", initial = "y", min = 0 }
[outputs]
y = "h_2"
[parameters]
k1 = { start = 0.05, min = 0.005, max = 0.5 }
k2 = { start = 0.05, min = 0.005, max = 0.5 }
pump = { start = 0.05, min = 0.005, max = 0.5 }
[[effect]]
id = "leak_lower"
adds = { h_2 = "-l*h_2" }
parameters = { l = { start = 0.001, min = 0, max = 0.1 } }
)toml",
                                    "tanks");
  ASSERT_TRUE(machine) << machine.error().text;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Episode episode;
  episode.signal.resize(800, 2);
  double h1 = 4, h2 = 4;
  for (int row = 0; row < 800; ++row) {
    const double t = 4.0 * row;
    const double volts = 3.3 + 1.3 * (std::sin(t / 85) + std::sin(t / 152 + 1) + 0.6 * std::sin(t / 41));
    episode.time.push_back(t);
    episode.signal(row, 0) = volts;
    episode.signal(row, 1) = h2 + 0.01 * normal(random);
    for (int step = 0; step < 20; ++step) {
      const double out = 0.06 * std::sqrt(h1);
      h1 = std::max(0.0, h1 + 0.2 * (0.045 * volts - out - 0.006 * h1));
      h2 = std::max(0.0, h2 + 0.2 * (out - 0.06 * std::sqrt(h2)));
    }
  }
  const StatesExplanation x = ExplainStates(*machine, std::span(&episode, 1));
  EXPECT_EQ(x.verdict, Verdict::kUnknown);
  EXPECT_THAT(x.nearest, testing::ElementsAre("leak_lower"));
  ASSERT_FALSE(x.warnings.empty());
  EXPECT_THAT(x.warnings.back().english, testing::HasSubstr("in the equation of h_1"));
}

}  // namespace
}  // namespace hydroscope
