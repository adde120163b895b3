#include "simulator/state_machines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace hydroscope {
namespace {

using State = std::array<double, 4>;
using Law = std::function<void(const State& x, double u, State& rate)>;

/// Runge and Kutta's method with small steps; `stop` is called after each.
StatesLog Integrate(const Law& law, const std::function<void(State&)>& stop, State x, double period,
                    int steps, const std::vector<double>& input, const std::vector<int>& measured) {
  StatesLog log;
  log.input = input;
  log.outputs.resize(measured.size());
  const double h = period / steps;
  for (std::size_t row = 0; row < input.size(); ++row) {
    log.time.push_back(static_cast<double>(row) * period);
    for (std::size_t j = 0; j < measured.size(); ++j)
      log.outputs[j].push_back(x[static_cast<std::size_t>(measured[j])]);
    for (int s = 0; s < steps; ++s) {
      State a{}, b{}, c{}, d{}, mid{};
      const auto at = [&](const State& rate, double by) {
        for (std::size_t i = 0; i < x.size(); ++i) mid[i] = x[i] + by * rate[i];
        return mid;
      };
      law(x, input[row], a);
      law(at(a, h / 2), input[row], b);
      law(at(b, h / 2), input[row], c);
      law(at(c, h), input[row], d);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
      stop(x);
    }
  }
  return log;
}

class Machines {
 public:
  explicit Machines(const SimulatedStates& simulated) : s_(simulated), random_(simulated.seed) {}

  StatesLog Run() {
    StatesLog log = s_.kind == StateMachineKind::kOscillator ? Oscillator()
                    : s_.kind == StateMachineKind::kTanks    ? Tanks()
                                                             : Actuator();
    std::normal_distribution<double> normal;
    for (std::vector<double>& output : log.outputs) {
      double mean = 0, square = 0;
      for (const double y : output) mean += y / static_cast<double>(output.size());
      for (const double y : output) square += (y - mean) * (y - mean) / static_cast<double>(output.size());
      log.noise.push_back(kNoise * std::sqrt(square));
      for (double& y : output) y += log.noise.back() * normal(random_);
    }
    return log;
  }

 private:
  static constexpr double kNoise = 0.005;  ///< of an output's variation

  double Draw(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool Hidden(const char* name) const { return s_.hidden == name; }

  /// A sum of sines below `highest` (of the sampling rate), of rms `size`.
  std::vector<double> Noiselike(double highest, double size) {
    constexpr int kSines = 120;
    std::vector<double> input(static_cast<std::size_t>(s_.rows), 0.0);
    for (int k = 0; k < kSines; ++k) {
      const double w = 2 * std::numbers::pi * Draw(0.001, highest), phase = Draw(0, 2 * std::numbers::pi);
      for (std::size_t row = 0; row < input.size(); ++row)
        input[row] += size * std::sqrt(2.0 / kSines) * std::sin(w * static_cast<double>(row) + phase);
    }
    return input;
  }
  std::vector<double> Steps(double low, double high, int hold) {
    std::vector<double> input;
    for (int row = 0; row < s_.rows; ++row) input.push_back(row % hold == 0 ? Draw(low, high) : input.back());
    return input;
  }

  StatesLog Oscillator() {
    const double period = 1.0 / 600, w = 2 * std::numbers::pi * Draw(45, 80), damping = Draw(0.02, 0.06),
                 size = Draw(0.6, 1.4);
    const double cubic = Hidden("cubic") ? Draw(2, 6) : 0, drag = Hidden("drag") ? Draw(0.5, 1.5) : 0,
                 coulomb = Hidden("coulomb") ? Draw(0.01, 0.03) : 0;
    const Law law = [=](const State& x, double u, State& rate) {
      rate[0] = x[1];
      const double v = x[1] / w;
      rate[1] = w * w *
                (u - x[0] - cubic * x[0] * x[0] * x[0] - 2 * damping * v - drag * v * std::abs(v) -
                 coulomb * std::tanh(x[1] / 0.5));
      rate[2] = rate[3] = 0;
    };
    return Integrate(law, [](State&) {}, {}, period, 12, Noiselike(0.25, 0.06 * size), {0});
  }

  StatesLog Tanks() {
    const double a = Draw(0.04, 0.07), b = Draw(0.04, 0.06), pump = Draw(0.05, 0.08);
    const double leak = Hidden("leak") ? Draw(0.004, 0.01) : 0;
    const Law law = [=](const State& x, double u, State& rate) {
      const double out = a * std::sqrt(std::max(x[0], 0.0));
      rate[0] = pump * u - out - leak * x[0];
      rate[1] = out - b * std::sqrt(std::max(x[1], 0.0));
      rate[2] = rate[3] = 0;
    };
    const State start = {Draw(2, 5), Draw(1, 4), 0, 0};
    const double filled = Draw(0.65, 0.85);
    const std::vector<double> input = Steps(1.5, 6.5, 25);
    double brim = 1e9;
    if (Hidden("overflow")) {  // what the first rows would fill it to, less a share
      constexpr std::size_t kFirst = 1000;
      const std::vector<double> first(
          input.begin(), input.begin() + static_cast<std::ptrdiff_t>(std::min(kFirst, input.size())));
      const StatesLog dry = Integrate(law, [](State&) {}, start, 4.0, 40, first, {0});
      brim = filled * *std::max_element(dry.outputs[0].begin(), dry.outputs[0].end());
    }
    return Integrate(law, [=](State& x) { x[0] = std::min(x[0], brim); }, start, 4.0, 40, input, {1});
  }

  StatesLog Actuator() {
    const double stiffness = Draw(2.5e3, 5e3), flow = Draw(0.8, 1.2), leak = Draw(0.05, 0.15),
                 spring = Draw(2e3, 4e3), damping = Draw(3, 8);
    const double coulomb = Hidden("coulomb") ? Draw(4, 10) : 0;
    const bool root = Hidden("root_flow");
    const double supply = Draw(25, 40);
    // Pressure, speed of the piston, spring travel, speed of the load; masses 1.
    const Law law = [=](const State& x, double u, State& rate) {
      const double drop = root ? std::sqrt(std::max(1 - (u > 0 ? x[0] : -x[0]) / supply, 0.0)) : 1;
      rate[0] = stiffness * (flow * u * drop - x[1] - leak * 0.1 * x[0]);
      rate[1] = x[0] - spring * x[2] - damping * (x[1] - x[3]) - coulomb * std::tanh(x[1] / 0.02);
      rate[2] = x[1] - x[3];
      rate[3] = spring * x[2] + damping * (x[1] - x[3]) - 2 * x[3];
    };
    return Integrate(law, [](State&) {}, {}, 0.004, 20, Noiselike(0.06, 0.5), {0, 1});
  }

  const SimulatedStates s_;
  std::mt19937_64 random_;
};

}  // namespace

StatesLog SimulateStates(const SimulatedStates& simulated) { return Machines(simulated).Run(); }

}  // namespace hydroscope
