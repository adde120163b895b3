#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <iomanip>
#include <random>

#include "core/limits.h"
#include "tests/command_line_fixture.h"

namespace hydroscope {
namespace {

using namespace command_line_test;
using testing::HasSubstr;

/// The most memory that this process had so far, MB.
double PeakMemory() {
  rusage used = {};
  getrusage(RUSAGE_SELF, &used);
  return 1e-3 * static_cast<double>(used.ru_maxrss);
}

/// A machine of the user's own with as many parameters as a balance may have.
class LargeModel : public CommandLine {
 protected:
  static constexpr int kRows = 12'000;
  static double Truth(int term) { return 1 + 0.1 * term; }

  /// U = sum of Truth(k) x_k, each x_k a sine of its own.
  std::string Log(int terms) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    std::ofstream out(File("large.csv"));
    out << "t,U,g" << std::setprecision(9);
    for (int k = 0; k < terms; ++k) out << ",x" << k;
    out << '\n';
    for (int row = 0; row < kRows; ++row) {
      const double t = 0.002 * row;
      double u = 1e-3 * normal(random);
      std::string signals;
      for (int k = 0; k < terms; ++k) {
        const double x = std::sin((0.4 + 0.37 * k) * t + 0.7 * k);
        u += Truth(k) * x;
        signals += fmt::format(",{:.9g}", x + 1e-5 * normal(random));
      }
      out << t << ',' << u << ',' << (std::fmod(t, 3.0) < 2.5 ? 1 : 0) << signals << '\n';
    }
    return File("large.csv");
  }
  std::string Machine(int terms, const std::string& library = "", const std::string& added = "") {
    std::string signals, balance;
    for (int k = 0; k < terms; ++k) {
      signals += fmt::format("x{0} = {{ column = \"x{0}\", unit = \"1\", stuck_time = 0 }}\n", k);
      balance += fmt::format("{}a{} = \"x{}\"", k == 0 ? "" : ", ", k, k);
    }
    WriteText(
        File("large.toml"),
        "[machine]\nname = \"large\"\n" + added +
            "[log]\ntime = { column = \"t\", unit = \"s\" }\n[signals]\n"
            "U = { column = \"U\", unit = \"V\", stuck_time = 0 }\n"
            "g = { column = \"g\", unit = \"1\", stuck_time = 0 }\n" +
            signals +
            "[gate]\nconditions = { g = { min = 0.5, unit = \"1\" } }\nstroke_gap = 0.05\nmin_stroke = 0.3\n"
            "[window]\nblock = 0.02\nspan = 0.3\nhalf_width = 0.04\n"
            "[balance]\noutput = \"U\"\nunit = \"V\"\nterms = { " +
            balance + " }\n" + library);
    return File("large.toml");
  }
};

TEST_F(LargeModel, OfAllSizesIsFittedExplainedAndReplayed) {
  for (const int terms : {11, 12, 13, 17, kMaxParameters}) {
    const std::string log = Log(terms), machine = Machine(terms),
                      db = File(fmt::format("large_{}.db", terms));
    const Ran fit = Run({"fit", log, "-m", machine, "--json", "-"});
    ASSERT_EQ(fit.exit_code, 0) << terms << fit.err;
    for (int k = 0; k < terms; ++k) {
      const nlohmann::json parameter = fit.Json()["parameters"][fmt::format("a{}", k)];
      EXPECT_NEAR(parameter["value"].get<double>(), Truth(k), 0.01) << terms << " a" << k;
    }
    EXPECT_EQ(Run({"explain", log, "-m", machine}).exit_code, 0) << terms;
    const Ran replay = Run({"replay", log, "-m", machine, "--db", db, "--json", "-"});
    ASSERT_EQ(replay.exit_code, 0) << terms << replay.err;
    EXPECT_NEAR(replay.Json()["parameters"]["a0"]["value"].get<double>(), Truth(0), 0.05) << terms;
    EXPECT_EQ(Run({"explain", "--db", db}).exit_code, 0) << terms;
    EXPECT_LT(PeakMemory(), 1000) << terms;  // laws of each pair of signals would be some GB
  }
}

/// Effects count as well: as many as fit are followed, one more is refused.
TEST_F(LargeModel, WithAddedEffectsUpToTheLimit) {
  const std::string effect =
      "[[effect]]\nid = \"square\"\ndescription = \"Square\"\nterms = { s = \"x0^2\" }\nunit = \"V\"\nmin = -10\n";
  const std::string added = "effects = [\"square\"]\n";
  const std::string log = Log(kMaxParameters);
  for (const int terms : {16, kMaxParameters - 1}) {
    const std::string machine = Machine(terms, effect, added);
    const Ran replay = Run({"replay", log, "-m", machine, "--db", File(fmt::format("more_{}.db", terms))});
    EXPECT_EQ(replay.exit_code, 0) << terms << replay.err;
    EXPECT_THAT(replay.out, HasSubstr("square.s")) << replay.out;
  }
  const Ran ran = Run({"fit", log, "-m", Machine(kMaxParameters, effect, added)});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, HasSubstr("32 parameters and 1 added effects, at most 32"));
}

TEST_F(LargeModel, BeyondTheLimitIsRefusedWithTheLimit) {
  const Ran ran = Run({"fit", Log(1), "-m", Machine(kMaxParameters + 1)});
  EXPECT_EQ(ran.exit_code, 3);
  EXPECT_THAT(ran.err, HasSubstr("33 terms, at most 32"));
}

}  // namespace
}  // namespace hydroscope
