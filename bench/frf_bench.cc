// Frequency response of a valve from stepped sines and from noise, 60 s at 1 kHz.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <random>

#include "estimation/frequency_response.h"

namespace hydroscope {
namespace {

constexpr double kPeriod = 1e-3;  // s
constexpr int kSamples = 60000;

/// Response of a first-order lag with 5 ms to `command`, with a little noise.
FrequencyRecord Lagged(std::vector<double> command) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 1e-3);
  SignalRun run;
  double state = 0;
  for (double u : command) {
    run.output.push_back(state + noise(random));
    state += (1 - std::exp(-kPeriod / 5e-3)) * (u - state);
  }
  run.input = std::move(command);
  return {kPeriod, {std::move(run)}};
}

FrequencyRecord SteppedSines() {
  std::vector<double> command;
  double phase = 0;
  for (int k = 0; k < kSamples; ++k) {
    const int step = k / 3000;
    phase += 2 * std::numbers::pi * (2.0 * std::pow(1.22, step)) * kPeriod;
    command.push_back(0.2 * std::sin(phase));
  }
  return Lagged(std::move(command));
}

FrequencyRecord Noise() {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0, 0.2);
  std::vector<double> command(kSamples);
  for (double& u : command) u = normal(random);
  return Lagged(std::move(command));
}

void Measure(benchmark::State& state, const FrequencyRecord& record, FrequencyResponseMethod method) {
  FrequencyResponseOptions options;
  options.method = method;
  for (auto _ : state) {
    const auto response = MeasureFrequencyResponse(record, options);
    if (!response) {
      state.SkipWithError(response.error().text.c_str());
      return;
    }
    benchmark::DoNotOptimize(response->points.data());
  }
  state.SetItemsProcessed(state.iterations() * kSamples);
}

void FrequencyResponseOfSteppedSines(benchmark::State& state) {
  Measure(state, SteppedSines(), FrequencyResponseMethod::kSine);
}
void FrequencyResponseOfNoise(benchmark::State& state) {
  Measure(state, Noise(), FrequencyResponseMethod::kWelch);
}

BENCHMARK(FrequencyResponseOfSteppedSines)->Unit(benchmark::kMillisecond);
BENCHMARK(FrequencyResponseOfNoise)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hydroscope
