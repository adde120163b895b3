#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "estimation/analytic_stroke_fixture.h"
#include "estimation/floor_trust.h"
#include "estimation/gram_fit.h"
#include "estimation/stroke_accumulator.h"
#include "estimation/stroke_segmenter.h"
#include "simulator/die_cushion/press.h"
#include "simulator/random.h"

namespace hydroscope {

/// Noise of one sensor from a stream of standard normal numbers.
using NoiseOfSensor = std::function<std::vector<double>(RandomStream&, std::size_t rows)>;

inline std::vector<double> WhiteNoise(RandomStream& random, std::size_t rows) {
  std::vector<double> noise(rows);
  for (double& e : noise) e = random.Normal();
  return noise;
}

/// First-order autoregression with variance 1.
inline NoiseOfSensor Filtered(double phi) {
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

/// White, and in one of twenty pieces of `rows_of_each` rows so many times as strong.
inline NoiseOfSensor Bursts(std::size_t rows_of_each, double times) {
  return [=](RandomStream& random, std::size_t rows) {
    constexpr std::size_t kPieces = 20;
    std::vector<double> noise = WhiteNoise(random, rows);
    for (std::size_t k = 0; k < rows; ++k)
      if (k / rows_of_each % kPieces == kPieces / 2) noise[k] *= times;
    return noise;
  };
}

/// For tests: a log of the simulated press with the geometry of the analytic machine and what the pipeline
/// makes of it.
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
  /// The machine file states the noise of a signal, SI.
  Machine& Stating(const char* signal, double noise) {
    machine.signals[machine.SignalIndex(signal)].noise_std = noise;
    return machine;
  }
};

inline PressOptions OneMinute(std::uint64_t seed) {
  PressOptions options;
  options.seconds = 60;
  options.seed = seed;
  return options;
}

/// Its signals without noise, simulated once.
inline const SimulatedLog& CleanMinute(std::uint64_t seed) {
  static std::map<std::uint64_t, SimulatedLog> by_seed;
  const auto [log, is_new] = by_seed.try_emplace(seed);
  if (is_new) log->second = SimulateClean(OneMinute(seed));
  return log->second;
}

/// Every `every`-th row of a log with noise `scale` times the rig's.
inline JudgedLog LogWith(std::uint64_t seed, const NoiseOfSensor& noise, double scale = 1, int every = 1) {
  const SimulatedLog& log = CleanMinute(seed);
  RandomStream random(seed + 1000);
  JudgedLog out;
  out.machine.gate.bounds = {{"y_v", false, 0.04, std::nullopt}, {"z", true, std::nullopt, -0.004}};
  out.machine.signals[out.machine.SignalIndex("p_A")].unit = "Pa";
  out.machine.signals[out.machine.SignalIndex("z")].unit = "m";
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
  const SensorNoise rig = OneMinute(seed).noise;
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

}  // namespace hydroscope
