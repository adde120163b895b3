#include "simulator/own_states/machines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace hydroscope {
namespace {

/// A sensor with its converter.
struct StateSensor {
  double gain = 1, zero = 0;
  double noise = 0;                                      ///< standard deviation, before the gain
  double coloured = 0;                                   ///< share of the noise's energy that remembers ...
  double memory = 0;                                     ///< ... this much of itself from row to row
  double step = 0;                                       ///< of the converter, before the gain
  double end = std::numeric_limits<double>::infinity();  ///< what is above is not shown

  /// Standard deviation of noise and steps.
  double Floor() const;
};

double StateSensor::Floor() const { return std::sqrt(noise * noise + step * step / 12); }

/// Readings of a quantity; NaN where the sensor is at its end.
std::vector<double> Sensed(const std::vector<double>& values, const StateSensor& sensor, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double slow = sensor.noise * std::sqrt(sensor.coloured),
               fast = sensor.noise * std::sqrt(1 - sensor.coloured),
               fresh = std::sqrt(1 - sensor.memory * sensor.memory);
  double remembered = normal(random);
  std::vector<double> out;
  for (const double value : values) {
    remembered = sensor.memory * remembered + fresh * normal(random);
    double reading = value + slow * remembered + fast * normal(random);
    if (reading >= sensor.end) {
      out.push_back(std::nan(""));
      continue;
    }
    if (sensor.step > 0) reading = sensor.step * std::round(reading / sensor.step);
    out.push_back(sensor.gain * reading + sensor.zero);
  }
  return out;
}

/// What is put on a machine's input to identify it.
enum class Excitation {
  kMultisine,      ///< many sines of random phase
  kFilteredNoise,  ///< white noise through a low pass of order 2
  kGrowing,        ///< the same, its amplitude growing from a tenth to all and again
  kSteps,          ///< levels held over random times
};

std::vector<double> Multisine(int rows, double highest, std::mt19937_64& random) {
  constexpr int kSines = 120;
  std::uniform_real_distribution<double> frequency(0.001, highest), phase(0, 2 * std::numbers::pi);
  std::vector<double> out(static_cast<std::size_t>(rows), 0.0);
  for (int k = 0; k < kSines; ++k) {
    const double w = 2 * std::numbers::pi * frequency(random), begin = phase(random);
    for (std::size_t row = 0; row < out.size(); ++row)
      out[row] += std::sqrt(2.0 / kSines) * std::sin(w * static_cast<double>(row) + begin);
  }
  return out;
}

/// Two lags in a row, brought back to unit rms.
std::vector<double> FilteredNoise(int rows, double highest, std::mt19937_64& random) {
  const double a = std::exp(-2 * std::numbers::pi * highest);
  // Energy of the impulse response n -> (n + 1) a^n: (1 + a^2) / (1 - a^2)^3.
  const double gain = std::sqrt(std::pow(1 - a * a, 3) / (1 + a * a));
  std::normal_distribution<double> normal;
  std::vector<double> out;
  double first = 0, second = 0;
  for (int row = 0; row < rows; ++row) {
    first = a * first + normal(random);
    second = a * second + first;
    out.push_back(gain * second);
  }
  return out;
}

std::vector<double> Steps(int rows, double highest, std::mt19937_64& random) {
  std::uniform_real_distribution<double> level(-1.7, 1.7), share(0.5, 1.5);
  std::vector<double> out;
  int left = 0;
  for (int row = 0; row < rows; ++row) {
    if (left-- <= 0) {
      out.push_back(level(random));
      left = static_cast<int>(share(random) / highest);
    } else {
      out.push_back(out.back());
    }
  }
  return out;
}

/// About zero, its rms about 1, with little above `highest` (cycles per row). A longer one of the same seed begins
/// with the shorter.
std::vector<double> ExcitationOf(Excitation kind, int rows, double highest, std::uint64_t seed) {
  constexpr int kGrowth = 1500;  // rows
  std::mt19937_64 random(seed);
  switch (kind) {
    case Excitation::kMultisine:
      return Multisine(rows, highest, random);
    case Excitation::kSteps:
      return Steps(rows, highest, random);
    case Excitation::kFilteredNoise:
    case Excitation::kGrowing:
      break;
  }
  std::vector<double> out = FilteredNoise(rows, highest, random);
  for (std::size_t row = 0; kind == Excitation::kGrowing && row < out.size(); ++row)
    out[row] *= 0.1 + 1.5 * static_cast<double>(row % kGrowth) / kGrowth;
  return out;
}

using State = std::array<double, 4>;

/// What acts on a machine: its input, a disturbance that is not measured (in the input's place and size), and the size of a
/// small law that no file has.
struct Drive {
  double input = 0, disturbance = 0, extra = 0;
};
using Law = std::function<void(const State& x, const Drive& drive, State& rate)>;

struct StatesPlant {
  Law law;
  std::function<void(State&)> stop = [](State&) {};  ///< called after each small step
  State start{};
  double period = 1;  ///< s
  int steps = 20;     ///< per row
  std::vector<double> input;
  std::vector<int> measured;  ///< states
  double newer = 0;           ///< share of a row after which they are measured
};

/// Sizes of what is small.
struct Disturbed {
  double extra = 0, disturbance = 0;
};

/// States at each row by Runge and Kutta's method with small steps.
std::vector<State> Course(const StatesPlant& plant, std::size_t rows, const Disturbed& by,
                          std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<State> course;
  const double h = plant.period / plant.steps;
  State x = plant.start;
  for (std::size_t row = 0; row < rows; ++row) {
    const Drive drive{plant.input[row], by.disturbance * normal(random), by.extra};
    const int read = static_cast<int>(std::lround(plant.newer * plant.steps));
    for (int s = 0; s < plant.steps; ++s) {
      if (s == read) course.push_back(x);
      State a{}, b{}, c{}, d{}, mid{};
      const auto at = [&](const State& rate, double step) {
        for (std::size_t i = 0; i < x.size(); ++i) mid[i] = x[i] + step * rate[i];
        return mid;
      };
      plant.law(x, drive, a);
      plant.law(at(a, h / 2), drive, b);
      plant.law(at(b, h / 2), drive, c);
      plant.law(at(c, h), drive, d);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
      plant.stop(x);
    }
  }
  return course;
}

double RmsDifference(const std::vector<State>& a, const std::vector<State>& b, int state) {
  double sum = 0;
  for (std::size_t row = 0; row < a.size(); ++row) {
    const double d = a[row][static_cast<std::size_t>(state)] - b[row][static_cast<std::size_t>(state)];
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(a.size()));
}

double Variation(const std::vector<State>& course, int state) {
  double mean = 0, square = 0;
  const auto n = static_cast<double>(course.size());
  for (const State& x : course) mean += x[static_cast<std::size_t>(state)] / n;
  for (const State& x : course) square += std::pow(x[static_cast<std::size_t>(state)] - mean, 2) / n;
  return std::sqrt(square);
}

class Machines {
 public:
  explicit Machines(const SimulatedStates& simulated) : s_(simulated), random_(simulated.seed) {}

  StatesLog Run() {
    StatesPlant plant = s_.kind == StateMachineKind::kOscillator ? Oscillator()
                        : s_.kind == StateMachineKind::kTanks    ? Tanks()
                                                                 : Actuator();
    plant.newer = s_.newer;
    StatesLog log;
    log.input = plant.input;
    for (std::size_t row = 0; row < plant.input.size(); ++row)
      log.time.push_back(static_cast<double>(row) * plant.period);
    if (s_.measured)  // the converter of the input has a gain of its own
      for (const double gain = Draw(0.98, 1.02); double& u : plant.input) u *= gain;

    // Sizes are those of the first rows, so that a longer log of the same seed goes on where a shorter one ends.
    const std::size_t first = std::min<std::size_t>(kFirst, plant.input.size());
    const std::vector<State> quiet = Course(plant, first, {}, 0);
    const double noise = s_.measured ? 0.002 * std::pow(4, Draw(0, 1)) : kNoise;
    Disturbed by;
    const double extra = s_.measured ? Draw(0.1, 0.5) : 0, disturbance = s_.measured ? Draw(0.1, 0.6) : 0;
    const int seen = plant.measured.front();
    if (s_.measured) {
      const double wanted = noise * Variation(quiet, seen);
      constexpr double kTried = 1e-3;
      by.extra = kTried * extra * wanted / RmsDifference(quiet, Course(plant, first, {kTried, 0}, 0), seen);
      by.disturbance = kTried * disturbance * wanted /
                       RmsDifference(quiet, Course(plant, first, {0, kTried}, s_.seed), seen);
    }
    const std::vector<State> course = Course(plant, plant.input.size(), by, s_.seed);
    for (const int state : plant.measured) {
      std::vector<double> values;
      for (const State& x : course) values.push_back(x[static_cast<std::size_t>(state)]);
      StateSensor sensor;
      sensor.noise = noise * Variation(quiet, state);
      if (s_.measured) DrawSensor(values, first, sensor);
      // Two outputs feel law and disturbance in different measure: what is counted is the first one's.
      log.noise.push_back(sensor.gain * sensor.Floor() *
                          std::sqrt(1 + extra * extra + disturbance * disturbance));
      log.outputs.push_back(Sensed(values, sensor, random_()));
    }
    return log;
  }

 private:
  static constexpr double kNoise = 0.005;  ///< of an output's variation
  static constexpr int kFirst = 1000;      ///< rows

  double Draw(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool Hidden(const char* name) const { return s_.hidden == name; }

  void DrawSensor(const std::vector<double>& values, std::size_t first, StateSensor& sensor) {
    const auto [low, high] =
        std::minmax_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
    sensor.gain = Draw(0.95, 1.05);
    if (s_.kind != StateMachineKind::kTanks) sensor.zero = Draw(-0.05, 0.05) * (*high - *low);
    sensor.step = Draw(0.2, 1) * sensor.noise;
    sensor.coloured = Draw(0, 0.7);
    sensor.memory = Draw(0.5, 0.9);
    if (Draw(0, 1) < 0.2) sensor.end = *low + 0.97 * (*high - *low);
  }

  std::vector<double> Excited(double highest) {
    if (!s_.measured) return ExcitationOf(Excitation::kMultisine, s_.rows, highest, random_());
    const auto kind = static_cast<Excitation>(random_() % 4);
    return ExcitationOf(kind, s_.rows, highest, random_());
  }

  StatesPlant Oscillator() {
    const double per_period = s_.measured ? Draw(5, 15) : 600 / Draw(45, 80);
    const double w = 2 * std::numbers::pi * 600 / per_period, damping = Draw(0.02, 0.06),
                 size = Draw(0.6, 1.4);
    const double cubic = Hidden("cubic") ? Draw(2, 6) : 0, drag = Hidden("drag") ? Draw(0.5, 1.5) : 0,
                 coulomb = Hidden("coulomb") ? Draw(0.01, 0.03) : 0;
    StatesPlant plant;
    plant.period = 1.0 / 600;
    plant.steps = 12;
    plant.law = [=](const State& x, const Drive& drive, State& rate) {
      const double v = x[1] / w;
      rate[0] = x[1];
      rate[1] = w * w *
                (drive.input + drive.disturbance - x[0] - cubic * x[0] * x[0] * x[0] - 2 * damping * v -
                 drag * v * std::abs(v) - coulomb * std::tanh(x[1] / 0.5) - drive.extra * std::abs(x[0]) * v);
      rate[2] = rate[3] = 0;
    };
    plant.input = Excited(s_.measured ? std::min(0.35, Draw(1.2, 2.5) / per_period) : 0.25);
    for (double& u : plant.input) u *= 0.06 * size;
    if (s_.measured) plant.start = {Draw(-0.1, 0.1), w * Draw(-0.1, 0.1), 0, 0};
    plant.measured = {0};
    return plant;
  }

  StatesPlant Tanks() {
    const double a = Draw(0.04, 0.07), b = Draw(0.04, 0.06), pump = Draw(0.05, 0.08);
    const double leak = Hidden("leak") ? Draw(0.004, 0.01) : 0;
    StatesPlant plant;
    plant.period = s_.measured ? Draw(2, 6) : 4;
    plant.steps = 40;
    plant.law = [=](const State& x, const Drive& drive, State& rate) {
      const double out = a * std::sqrt(std::max(x[0], 0.0));
      rate[0] = pump * (drive.input + drive.disturbance) - out - leak * x[0];
      rate[1] =
          out - b * std::sqrt(std::max(x[1], 0.0)) - drive.extra * b * x[1] * std::sqrt(std::max(x[1], 0.0));
      rate[2] = rate[3] = 0;
    };
    plant.start = {Draw(2, 5), Draw(1, 4), 0, 0};
    plant.measured = {1};
    plant.input = s_.measured ? Excited(0.05 * Draw(0.5, 1))
                              : ExcitationOf(Excitation::kSteps, s_.rows, 1.0 / 25, random_());
    for (double& u : plant.input) u = std::clamp(4 + 1.45 * u, 0.5, 9.0);
    const double filled = Draw(0.65, 0.85), share = Hidden("spill") ? Draw(0.25, 0.6) : 0;
    if (!Hidden("overflow") && !Hidden("spill")) return plant;
    // Its brim is a share of what the first rows would fill it to.
    const std::size_t first = std::min<std::size_t>(kFirst, plant.input.size());
    double highest = 0;
    for (const State& x : Course(plant, first, {}, 0)) highest = std::max(highest, x[0]);
    plant.stop = [brim = filled * highest, share](State& x) {
      x[1] += share * std::max(x[0] - brim, 0.0);
      x[0] = std::min(x[0], brim);
    };
    return plant;
  }

  StatesPlant Actuator() {
    const double stiffness = Draw(2.5e3, 5e3), flow = Draw(0.8, 1.2), leak = Draw(0.05, 0.15),
                 spring = Draw(2e3, 4e3), damping = Draw(3, 8);
    const double coulomb = Hidden("coulomb") ? Draw(4, 10) : 0;
    const bool root = Hidden("root_flow");
    const double supply = Draw(25, 40);
    StatesPlant plant;
    // Pressure, speed of the piston, spring travel, speed of the load; masses 1.
    plant.law = [=](const State& x, const Drive& drive, State& rate) {
      const double u = drive.input,
                   drop = root ? std::sqrt(std::max(1 - (u > 0 ? x[0] : -x[0]) / supply, 0.0)) : 1;
      rate[0] = stiffness * (flow * u * drop - x[1] - leak * 0.1 * x[0]);
      rate[1] = x[0] - spring * x[2] - damping * (x[1] - x[3]) - coulomb * std::tanh(x[1] / 0.02);
      rate[2] = x[1] - x[3];
      rate[3] = spring * x[2] + damping * (x[1] - x[3]) - 2 * x[3] + 10 * drive.disturbance -
                10 * drive.extra * x[3] * std::abs(x[3]);
    };
    const double per_period = Draw(5, 15);
    plant.period = s_.measured ? 2 * std::numbers::pi / std::sqrt(2 * spring) / per_period : 0.004;
    plant.input = Excited(s_.measured ? Draw(0.4, 1.2) / per_period : 0.06);
    for (double& u : plant.input) u *= 0.5;
    if (s_.measured) plant.start = {Draw(-5, 5), Draw(-0.2, 0.2), Draw(-0.005, 0.005), Draw(-0.2, 0.2)};
    plant.measured = {0, 1};
    return plant;
  }

  const SimulatedStates s_;
  std::mt19937_64 random_;
};

}  // namespace

StatesLog SimulateStates(const SimulatedStates& simulated) { return Machines(simulated).Run(); }

}  // namespace hydroscope
