#include "service/log_trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "service/benchmarks/simulated_strokes.h"
#include "service/compare_log.h"
#include "service/compare_output.h"
#include "service/explain_log.h"
#include "service/explain_output.h"
#include "service/fit_output.h"
#include "service/fit_suspicion.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Every `every`-th row of a log of a random machine.
LogStrokes Thinned(std::uint64_t seed, const std::vector<EffectSetting>& effects, std::size_t every) {
  PressOptions options = RandomMachine(seed);
  options.seconds = 90;
  options.effects = effects;
  const SimulatedLog full = SimulatePress(options);
  SimulatedLog log;
  log.truth = full.truth;
  log.truth.options.sample_period *= static_cast<double>(every);
  for (std::size_t k = 0; k < full.rows(); k += every) log.Append(full.Row(k));
  return *StrokesOf(log, MachineFor(options), KeepSamples::kYes);
}

TEST(LogTrust, GivesNoVerdictWhereRowsAreTooFarApart) {
  for (const std::uint64_t seed : {1, 2}) {
    const auto result = ExplainStrokes(Thinned(seed, {{"internal_leakage", 1e-12, {}}}, 50));
    ASSERT_TRUE(result) << result.error().text;
    const Explanation& x = result->explanation;
    EXPECT_EQ(x.verdict, Verdict::kUnknown);
    EXPECT_THAT(x.set, IsEmpty());
    EXPECT_THAT(x.warnings, Contains(HasSubstr("sampled too slowly for this: rows every 100 ms")));
    EXPECT_THAT(ExplainText(*result), HasSubstr("this log carries no verdict"));
    const nlohmann::json json = ExplainJson(*result);
    EXPECT_EQ(json.at("verdict"), "unknown");
    EXPECT_FALSE(json.at("sampling").at("fast_enough").get<bool>());
    EXPECT_NEAR(json.at("sampling").at("period_s").get<double>(), 0.1, 1e-9);
  }
}

TEST(LogTrust, LeavesVerdictsOfDenseRowsAsTheyAre) {
  for (const std::size_t every : {1, 5}) {
    const LogTrust trust = JudgeStrokes(Thinned(3, {}, every));
    EXPECT_TRUE(trust.rate.fast_enough) << every << trust.rate.sentence;
    EXPECT_TRUE(trust.floor.believable) << every << trust.floor.why;
    EXPECT_THAT(trust.Warnings(), IsEmpty());
  }
}

/// A mass on a spring, 9 Hz and hardly damped, driven by a force that changes every second: force and
/// position at `rate` rows a second, with sensor noise, as a log and its machine file.
struct Oscillator {
  std::string log, machine;

  Oscillator(double rate, const std::string& stated) {
    constexpr double kMass = 2, kDamping = 0.5, kStiffness = 2 * 81 * 39.478;
    log = testing::TempDir() + "oscillator.csv";
    machine = testing::TempDir() + "oscillator.toml";
    std::ofstream rows(log);
    rows << "t,F,x,on\n";
    RandomStream random(11);
    double x = 0, v = 0, force = 0, next = 0;
    const double step = 1e-4;
    const int every = static_cast<int>(std::lround(1 / (rate * step)));
    for (int k = 0; k < 1200000; ++k) {
      const double t = k * step;
      if (t >= next) {
        force = random.Uniform(-100, 100);
        next = t + random.Uniform(0.4, 1.2);
      }
      v += step * (force - kDamping * v - kStiffness * x) / kMass;
      x += step * v;
      if (k % every == 0)
        rows << t << ',' << force + 0.05 * random.Normal() << ',' << x + 1e-6 * random.Normal() << ','
             << (std::fmod(t, 10) < 9 ? 1 : 0) << '\n';
    }
    std::ofstream(machine) << "[machine]\nname = \"oscillator\"\n[signals]\n"
                              "F = { column = \"F\", unit = \"N\", stuck_time = 0"
                           << (stated.empty() ? "" : ", noise = 0.05")
                           << " }\nx = { column = \"x\", unit = \"m\", stuck_time = 0"
                           << (stated.empty() ? "" : ", noise = 1e-6")
                           << " }\non = { column = \"on\", stuck_time = 0 }\n"
                              "[gate]\nconditions = { on = { min = 0.5 } }\n"
                              "[balance]\noutput = \"F\"\nunit = \"N\"\nterms = { m = \"ddt(ddt(x))\", d = "
                              "\"ddt(x)\", k = \"x\" }\n"
                              "[[effect]]\nid = \"cubic\"\nterms = { c = \"x*x*x\" }\n";
  }
};

TEST(LogTrust, GivesNoVerdictOnAnOscillatorNearItsSamplingRate) {
  for (const double rate : {20.0, 25.0})
    for (const char* stated : {"", "yes"}) {
      const Oscillator oscillator(rate, stated);
      const auto result = ExplainLog(oscillator.log, oscillator.machine);
      ASSERT_TRUE(result) << result.error().text;
      EXPECT_NE(result->explanation.verdict, Verdict::kAdequate) << rate << stated;
      EXPECT_THAT(result->explanation.set, IsEmpty()) << rate << stated;
      EXPECT_THAT(result->explanation.warnings, Contains(HasSubstr("sampled too slowly"))) << rate << stated;
    }
}

TEST(LogTrust, FitAndCompareSayWhyTheyCannotBeTrusted) {
  const Oscillator oscillator(20, "");
  const auto fit = FitLog(oscillator.log, oscillator.machine);
  ASSERT_TRUE(fit) << fit.error().text;
  EXPECT_TRUE(fit->too_slow);
  EXPECT_THAT(SuspectFit(fit->log).warnings, Contains(HasSubstr("sampled too slowly")));
  EXPECT_THAT(FitText(*fit), HasSubstr("NOT TO BE TRUSTED"));
  EXPECT_EQ(FitJson(*fit).at("parameters").at("k").at("reason"), "sampled_too_slowly");
  const auto compared = CompareLog(oscillator.log, oscillator.machine);
  ASSERT_TRUE(compared) << compared.error().text;
  EXPECT_THAT(CompareText(*compared), HasSubstr("This log carries no verdict"));
  EXPECT_FALSE(CompareJson(*compared).at("warnings").empty());
}

}  // namespace
}  // namespace hydroscope
