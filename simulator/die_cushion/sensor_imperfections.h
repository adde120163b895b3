#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/die_cushion/imperfections.h"
#include "simulator/die_cushion/sensors.h"

namespace hydroscope {

/// First-order lag, exact for an input that is constant over each step; begins at its first input.
class FirstOrderLag {
 public:
  /// `time` s; 0: what goes in comes out. `step` s.
  FirstOrderLag(double time, double step);
  double Step(double input);

 private:
  double keep_;  // 1, share of the old value that is left after a step
  double value_ = 0;
  bool begun_ = false;
};

/// What imperfect sensors, converters and transports make of row after row. They act on what is logged; the
/// controller keeps its own readings. The result depends on list, options and row number alone.
class SensorImperfections {
 public:
  /// `options`: standard deviations of the noise, sample period, length and noise seed (resolved, not 0).
  SensorImperfections(const std::vector<Imperfection>& list, const PressOptions& options);

  /// What the sensor shows without noise: gain, zero and its drift, hum, a bad stretch, a signal that stands.
  void Distort(PressRow& row);
  /// The noise of this row, made of the white one: coloured, with heavy tails.
  std::array<double, 7> Noise(const std::array<double, 7>& white);
  /// The reading, noise and all, on its way to the log: filter, spikes, limits, steps, a stuck value, wrong
  /// unit, time stamp. False if the row is lost.
  bool Transport(PressRow& row);

 private:
  struct Active {
    Imperfection one;
    RandomStream random;
    std::array<double, 7> held{};
    std::array<long, 7> rows_left{};  ///< of a spike
    std::array<bool, 7> begun{};
  };
  template <typename Change>
  void ForChannels(Active& active, PressRow& row, const Change& change);
  void Filter(Active& active, PressRow& row);
  void Hold(Active& active, PressRow& row);
  void Spike(Active& active, PressRow& row);
  /// Repeats readings until `is_new(channel, reading, held)`.
  template <typename IsNew>
  void Repeat(Active& active, PressRow& row, const IsNew& is_new);

  std::vector<Active> active_;
  std::array<double, 7> std_;
  double period_, seconds_;
};

}  // namespace hydroscope
