#include "estimation/floor_trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "estimation/analytic_stroke.h"
#include "estimation/gram_fit.h"
#include "estimation/stroke_accumulator.h"
#include "estimation/stroke_segmenter.h"
#include "simulator/press.h"
#include "simulator/random.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Noise of one sensor from a stream of standard normal numbers.
using NoiseOfSensor = std::function<std::vector<double>(RandomStream&, std::size_t rows)>;

std::vector<double> WhiteNoise(RandomStream& random, std::size_t rows) {
  std::vector<double> noise(rows);
  for (double& e : noise) e = random.Normal();
  return noise;
}

/// First-order autoregression with variance 1.
NoiseOfSensor Filtered(double phi) {
  return [phi](RandomStream& random, std::size_t rows) {
    std::vector<double> noise(rows);
    double e = random.Normal();
    for (double& out : noise) {
      out = e;
      e = phi * e + std::sqrt(1 - phi * phi) * random.Normal();
    }
    return noise;
  };
}

/// A log of the simulated press with the geometry of the analytic machine and what the pipeline makes of it.
struct JudgedLog {
  Machine machine = AnalyticMachine();
  std::shared_ptr<const ModelStructure> model;
  std::vector<std::vector<Stretch>> strokes;
  std::vector<StrokeGram> grams;
  WindowSamples window;

  FloorTrust Judge() const {
    const auto fit = FitBaseModel(*model, grams, window);
    return JudgeFloor(*model, strokes, window, fit->theta, machine);
  }
  Machine& Stating(const char* signal, double noise) {
    machine.signals[static_cast<std::size_t>(machine.SignalIndex(signal))].noise_std = noise;
    return machine;
  }
};

/// Every `every`-th row of a log with noise `scale` times the rig's.
JudgedLog LogWith(std::uint64_t seed, const NoiseOfSensor& noise, double scale = 1, int every = 1) {
  PressOptions options;
  options.seconds = 60;
  options.seed = seed;
  const SimulatedLog log = SimulateClean(options);
  RandomStream random(seed + 1000);
  JudgedLog out;
  out.machine.gate.bounds = {{"y_v", false, 0.04, std::nullopt}, {"z", true, std::nullopt, -0.004}};
  out.machine.signals[static_cast<std::size_t>(out.machine.SignalIndex("p_A"))].unit = "Pa";
  out.machine.signals[static_cast<std::size_t>(out.machine.SignalIndex("z"))].unit = "m";
  out.model = *BuildModel(out.machine);
  const double period = 0.002 * every;
  out.window = WindowSamples::From(WindowSpec{}, period);
  const auto read = [&](const std::vector<double>& clean, double std) {
    const std::vector<double> e = noise(random, clean.size());
    std::vector<double> rows;
    for (std::size_t k = 0; k < clean.size(); k += static_cast<std::size_t>(every))
      rows.push_back(clean[k] + scale * std * e[k]);
    return rows;
  };
  SampleBlock rows;
  const auto thinned = read(log.t, 0);
  rows.Resize(out.machine.signals.size(), thinned.size());
  rows.time = thinned;
  const SensorNoise& rig = options.noise;
  rows.signal = {read(log.p_A, rig.p_A), read(log.z, rig.z),     read(log.y_v, rig.y_v),
                 read(log.p_B, rig.p_B), read(log.p_0, rig.p_0), read(log.T_oil, 0)};
  SpanEquationBuilder builder(out.model, out.window);
  StrokeAccumulator accumulator(out.model->column_count());
  std::vector<Stretch> stretches;
  StrokeSegmenter segmenter(out.machine, out.model, out.window,
                            {[&](Stretch& s, double begin) {
                               accumulator.Add(builder.Build(s, begin));
                               stretches.push_back(s);
                             },
                             [&](const StrokeSummary&) {
                               out.grams.push_back(accumulator.Take());
                               out.strokes.push_back(std::move(stretches));
                               stretches.clear();
                             },
                             [&] {
                               accumulator.Take();
                               stretches.clear();
                             }});
  segmenter.Process(rows);
  segmenter.Finish();
  return out;
}

TEST(FloorTrust, BelievesTheFloorOfWhiteNoise) {
  for (const double scale : {0.1, 1.0, 3.0})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const FloorTrust trust = LogWith(seed, WhiteNoise, scale).Judge();
      EXPECT_TRUE(trust.believable) << seed << " " << scale << ": " << trust.why;
      EXPECT_THAT(trust.sentences, IsEmpty());
      EXPECT_EQ(trust.noise_scale, 1.0);
    }
}

TEST(FloorTrust, SeesNoiseThatAFilterHasPassed) {
  for (const double phi : {0.3, 0.5, 0.8, 0.95}) {
    const FloorTrust trust = LogWith(1, Filtered(phi), 0.5).Judge();
    EXPECT_FALSE(trust.believable) << phi;
    EXPECT_GT(trust.noise_scale, 1.15) << phi;
    EXPECT_THAT(trust.why, HasSubstr("noise of z is not white")) << phi;
  }
}

TEST(FloorTrust, CountsPositionAndPressureAsTheBalanceDoes) {
  const FloorTrust trust = LogWith(2, WhiteNoise).Judge();
  ASSERT_GE(trust.signals.size(), 2u);
  EXPECT_EQ(trust.signals[0].name, "z");
  EXPECT_EQ(trust.signals[1].name, "p_A");
  EXPECT_NEAR(trust.signals[0].std, 1.2e-4, 4e-6);
  EXPECT_NEAR(trust.signals[1].std, 2.2e5, 7e3);
  double sum = 0;
  for (const SignalNoise& signal : trust.signals) sum += signal.share;
  EXPECT_NEAR(sum, 1, 1e-9);
  // Real motion of the spool is no noise of the balance.
  for (const SignalNoise& signal : trust.signals)
    EXPECT_TRUE(signal.name != "y_v" || signal.share < 0.02) << signal.share;
}

TEST(FloorTrust, HoldsTheContrastsAgainstWhatTheMachineFileStates) {
  JudgedLog log = LogWith(3, WhiteNoise);
  log.Stating("z", 1.2e-4);
  log.Stating("p_A", 2.2e5);
  EXPECT_TRUE(log.Judge().believable);
  log.Stating("z", 3e-5);
  const FloorTrust less = log.Judge();
  EXPECT_FALSE(less.believable);
  EXPECT_EQ(less.signals[0].kind, NoiseKind::kSignalInContrast);
  EXPECT_THAT(less.why, HasSubstr("its stated noise is 0.03 mm"));
  EXPECT_LT(less.noise_scale, 0.5);
  log.Stating("z", 3e-4);
  EXPECT_EQ(log.Judge().signals[0].kind, NoiseKind::kDisagreesWithStated);
}

TEST(FloorTrust, DoesNotTakeAPressureThatMovesFromRowToRowForNoise) {
  const FloorTrust trust = LogWith(4, WhiteNoise, 0.1, 10).Judge();
  ASSERT_GE(trust.signals.size(), 2u);
  const auto pressure = std::find_if(trust.signals.begin(), trust.signals.end(),
                                     [](const SignalNoise& s) { return s.name == "p_A"; });
  ASSERT_NE(pressure, trust.signals.end());
  EXPECT_EQ(pressure->kind, NoiseKind::kSignalInContrast) << pressure->sentence;
  EXPECT_FALSE(trust.believable);
}

}  // namespace
}  // namespace hydroscope
