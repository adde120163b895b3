#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "models/effect.h"
#include "models/stretch.h"

namespace hydroscope::effects {

/// Effect::Twin::least of a lag beside the delay of its signal: to first order they are one law, and in
/// `hydroscope benchmark late-signals --cases 96 --seed 771` each gains nine tenths of what the other does at least. A lag whose
/// delay does not takes noise out of what it smooths, which strokes of one speed do not contradict.
inline constexpr double kDelayGains = 0.5;

/// What the lags of all signals share: one time constant, at once the size and the shape of the law.
inline Effect FirstOrderLag() {
  Effect e;
  e.parameter = "tau";
  e.unit = "s";
  e.max = 0.1;
  e.typical = 0.002;
  e.nonlinear = {{"lag", "s", 0.0002, 0.1}};
  e.implied = [](const ShapeContext& c) { return c.size; };
  return e;
}

/// Increments between samples of a signal behind a first-order lag of `lag` s, which has followed it since as long as it is
/// known, on a ramp at first; exact for a signal that is a line between samples. `signal(k)` for k from -before on.
template <typename Signal>
void LowPassedDifferences(const Stretch& s, double lag, Signal signal, std::span<double> increments) {
  constexpr int kSlope = 10;  // samples whose mean slope the ramp takes
  const double ratio = lag / s.period, decay = std::exp(-1.0 / ratio);
  const double of_last = ratio * (1.0 - decay) - decay, of_next = 1.0 - ratio * (1.0 - decay);
  const int first = -s.before, reach = std::min(kSlope, s.before + s.samples - 1);
  double last = signal(first);
  double y = reach > 0 ? last - lag * (signal(first + reach) - last) / (reach * s.period) : last;
  for (int k = first + 1; k < s.samples; ++k) {
    const double next = signal(k), before = y;
    y = decay * y + of_last * last + of_next * next;
    last = next;
    if (k > 0) increments[static_cast<std::size_t>(k) - 1] = y - before;
  }
}

}  // namespace hydroscope::effects
