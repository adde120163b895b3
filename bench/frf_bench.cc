// Frequency response of a valve from stepped sines and from noise, 60 s at 1 kHz, its model included. Writes the
// noise for scipy_csd.py (bench/frf.sh runs both).

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <numbers>
#include <random>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope {
namespace {

constexpr double kPeriod = 1e-3;  // s
constexpr int kSamples = 60000;

/// Response of a valve of 80 Hz and damping 0.7 to `command`, with a little noise.
FrequencyRecord Followed(std::vector<double> command) {
  constexpr int kSubsteps = 20;
  constexpr double kOmega = 2 * std::numbers::pi * 80, kDamping = 0.7, kStep = kPeriod / kSubsteps;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 1e-3);
  SignalRun run;
  double position = 0, speed = 0;
  for (double u : command) {
    run.output.push_back(position + noise(random));
    for (int k = 0; k < kSubsteps; ++k) {
      speed += kStep * kOmega * (kOmega * (u - position) - 2 * kDamping * speed);
      position += kStep * speed;
    }
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
  return Followed(std::move(command));
}

FrequencyRecord Noise() {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0, 0.2);
  std::vector<double> command(kSamples);
  double once = 0, twice = 0;  // through two lags of 1.4 ms, as an amplifier has
  for (double& u : command) {
    once += 0.5 * (normal(random) - once);
    u = twice += 0.5 * (once - twice);
  }
  return Followed(std::move(command));
}

/// CPU seconds of one evaluation, best of `repeats`; negative if it fails.
double Best(const FrequencyRecord& record, FrequencyResponseMethod method, int repeats) {
  FrequencyResponseOptions options;
  options.method = method;
  double best = -1;
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t start = std::clock();
    const auto response = MeasureFrequencyResponse(record, options);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    if (!response || !response->model) return -1;
    if (best < 0 || seconds < best) best = seconds;
  }
  return best;
}

/// Command, then response, as doubles: what the peer evaluates.
bool Write(const SignalRun& run, const char* path) {
  std::ofstream file(path, std::ios::binary);
  for (const std::vector<double>* signal : {&run.input, &run.output}) {
    file.write(reinterpret_cast<const char*>(signal->data()),
               static_cast<std::streamsize>(signal->size() * sizeof(double)));
  }
  return static_cast<bool>(file);
}

int Run(const char* path, int repeats) {
  const FrequencyRecord noise = Noise();
  if (!Write(noise.runs[0], path)) return 1;
  const double sines = Best(SteppedSines(), FrequencyResponseMethod::kSine, repeats);
  const double welch = Best(noise, FrequencyResponseMethod::kWelch, repeats);
  std::printf("stepped_sines_and_model %.6f\nnoise_and_model %.6f\n", sines, welch);
  return sines > 0 && welch > 0 ? 0 : 1;
}

}  // namespace
}  // namespace hydroscope

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: frf_bench FILE_FOR_THE_NOISE [REPEATS]\n");
    return 2;
  }
  return hydroscope::Run(argv[1], argc > 2 ? std::atoi(argv[2]) : 20);
}
