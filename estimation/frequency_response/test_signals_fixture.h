#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "estimation/frequency_response/frequency_response.h"

namespace hydroscope::test_signals {

/// A second-order valve with dead time, and the sweep it is given. Used by the tests only.
struct Sweep {
  double f0 = 183.9, damping = 0.6735, gain = 1.005, dead_time = 0;
  std::vector<double> frequencies = {10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110, 120, 130, 140, 150, 160};
  double hold = 1.0;   // s per frequency
  double pause = 0.0;  // s of zero command between frequencies
  double amplitude = 0.05;
  double sampling = 1000;  // Hz
  double noise = 6.8e-5;   // of the response
  double input_noise = 0;
  double offset = 0.008;  // of the response

  bool operator==(const Sweep&) const = default;
};

/// Standard normal numbers, the same on every platform.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}
  double operator()() {
    const double u = (static_cast<double>(engine_() >> 11) + 0.5) * 0x1p-53;
    const double v = static_cast<double>(engine_() >> 11) * 0x1p-53;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }

 private:
  std::mt19937_64 engine_;
};

inline std::complex<double> TrueResponse(const Sweep& s, double frequency) {
  const double r = frequency / s.f0;
  return s.gain / std::complex<double>(1 - r * r, 2 * s.damping * r) *
         std::polar(1.0, -2 * std::numbers::pi * frequency * s.dead_time);
}

/// Command sin(w (t - t_k)) from each switch t_k on; the response is exact: steady state plus the transient
/// that keeps position and speed continuous at every switch. Without noise.
inline SignalRun CleanRun(const Sweep& s) {
  using Complex = std::complex<double>;
  struct Piece {
    double begin, omega, amplitude;
    Complex steady, first, second;  // response: Im(steady e^{iwt}) + Re(first e^{s1 t} + second e^{s2 t})
  };
  const double omega_0 = 2 * std::numbers::pi * s.f0;
  const Complex root = std::sqrt(Complex(s.damping * s.damping - 1, 1e-12));
  const Complex s1 = omega_0 * (-s.damping + root), s2 = omega_0 * (-s.damping - root);
  std::vector<Piece> pieces;
  double time = 0, position = 0, speed = 0;
  const auto add = [&](double frequency, double duration) {
    const double omega = 2 * std::numbers::pi * frequency;
    Piece p{time, omega, frequency > 0 ? s.amplitude : 0, 0, 0, 0};
    const double r = frequency / s.f0;
    p.steady = p.amplitude * s.gain / Complex(1 - r * r, 2 * s.damping * r);
    const double y = position - p.steady.imag(), v = speed - (Complex(0, omega) * p.steady).imag();
    p.second = (v - s1 * y) / (s2 - s1);
    p.first = y - p.second;
    pieces.push_back(p);
    const Complex a = p.first * std::exp(s1 * duration), b = p.second * std::exp(s2 * duration);
    const Complex wave = p.steady * std::polar(1.0, omega * duration);
    position = wave.imag() + (a + b).real();
    speed = (Complex(0, omega) * wave).imag() + (s1 * a + s2 * b).real();
    time += duration;
  };
  for (const double frequency : s.frequencies) {
    add(frequency, s.hold);
    if (s.pause > 0) add(0, s.pause);
  }
  SignalRun run;
  const auto samples = static_cast<std::size_t>(time * s.sampling);
  std::size_t now = 0, delayed = 0;
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = static_cast<double>(n) / s.sampling;
    while (now + 1 < pieces.size() && t >= pieces[now + 1].begin) ++now;
    while (delayed + 1 < pieces.size() && t - s.dead_time >= pieces[delayed + 1].begin) ++delayed;
    const Piece& u = pieces[now];
    const Piece& y = pieces[delayed];
    const double local = t - s.dead_time - y.begin;
    double response = s.offset;
    if (local >= 0) {
      response += (y.steady * std::polar(1.0, y.omega * local)).imag() +
                  (y.first * std::exp(s1 * local) + y.second * std::exp(s2 * local)).real();
    }
    run.input.push_back(u.amplitude * std::sin(u.omega * (t - u.begin)));
    run.output.push_back(response);
  }
  return run;
}

/// The same with noise; what seeds have in common is computed once for those that follow one another.
inline FrequencyRecord Simulate(const Sweep& s, std::uint64_t seed) {
  static Sweep last{.frequencies = {}};
  static SignalRun clean;
  if (s != last) clean = CleanRun(last = s);
  FrequencyRecord record{1 / s.sampling, {clean}};
  SignalRun& run = record.runs[0];
  Normal normal(seed);
  for (std::size_t n = 0; n < run.input.size(); ++n) {
    run.input[n] += s.input_noise * normal();
    run.output[n] += s.noise * normal();
  }
  return record;
}

}  // namespace hydroscope::test_signals
