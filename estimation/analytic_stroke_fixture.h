#pragma once

#include <cmath>
#include <memory>
#include <numbers>

#include "machines/die_cushion/balance.h"
#include "models/machine.h"

namespace hydroscope {

/// A noise-free drawing stroke in closed form, for tests: pressure and spool are sums of sines, and the
/// position follows from the balance A dz/dt = theta1 root y + theta2 dp + theta3 z dp + theta4 root by a
/// Runge-Kutta integration so fine that its error is below the rounding of the test.
class AnalyticStroke {
 public:
  static constexpr double kArea = 0.0125, kDpNom = 35e5;
  static constexpr double kBulk = 1.21e9, kDead = 1.65e-3, kFlow = 1.7e-3, kNull = 0.008;

  explicit AnalyticStroke(double start) : z_(start) {}

  static double Pressure(double t) {
    return 90e5 + 30e5 * std::sin(2 * kPi * 1.3 * t) + 12e5 * std::sin(2 * kPi * 4.1 * t + 1);
  }
  static double Spool(double t) {
    return 0.22 + 0.08 * std::sin(2 * kPi * 0.9 * t) + 0.03 * std::cos(2 * kPi * 3.3 * t);
  }
  static Eigen::Vector4d Theta() {
    const double gain = kFlow / std::sqrt(kDpNom);
    return {-gain, -kDead / kBulk, -kArea / kBulk, gain * kNull};
  }
  double time() const { return t_; }
  double position() const { return z_; }
  /// Goes on by `step` s.
  void Advance(double step) {
    constexpr int kFine = 40;
    const double h = step / kFine;
    for (int k = 0; k < kFine; ++k) {
      const double k1 = Speed(t_, z_), k2 = Speed(t_ + h / 2, z_ + h / 2 * k1);
      const double k3 = Speed(t_ + h / 2, z_ + h / 2 * k2), k4 = Speed(t_ + h, z_ + h * k3);
      z_ += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      t_ += h;
    }
  }

 private:
  static constexpr double kPi = std::numbers::pi;
  static double PressureRate(double t) {
    return 30e5 * 2 * kPi * 1.3 * std::cos(2 * kPi * 1.3 * t) +
           12e5 * 2 * kPi * 4.1 * std::cos(2 * kPi * 4.1 * t + 1);
  }
  static double Speed(double t, double z) {
    const Eigen::Vector4d theta = Theta();
    const double root = std::sqrt(Pressure(t)), rate = PressureRate(t);
    return (theta[0] * root * Spool(t) + theta[1] * rate + theta[2] * z * rate + theta[3] * root) / kArea;
  }

  double t_ = 0, z_;
};

/// The machine of the analytic stroke, with every signal the library of effects reads.
inline Machine AnalyticMachine() {
  Machine machine;
  machine.name = "analytic";
  for (const char* name : {"p_A", "z", "y_v", "p_B", "p_0", "T_oil"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    machine.signals.push_back(signal);
  }
  machine.geometry["A_A"] = {AnalyticStroke::kArea, 0};
  machine.geometry["dp_nom"] = {AnalyticStroke::kDpNom, 0};
  machine.geometry["p_t"] = {0, 0};
  return machine;
}

/// `samples` consecutive samples of the stroke `period` apart.
inline Stretch SampleStroke(const ModelStructure& model, AnalyticStroke& stroke, int samples, double period) {
  Stretch s;
  s.samples = samples;
  s.period = period;
  s.begin = stroke.time();
  s.channel.assign(model.channel_names.size(), std::vector<double>(samples));
  for (int k = 0; k < samples; ++k) {
    if (k > 0) stroke.Advance(period);
    const double t = stroke.time();
    s.channel[kPressureA][k] = AnalyticStroke::Pressure(t);
    s.channel[kPosition][k] = stroke.position();
    s.channel[kSpool][k] = AnalyticStroke::Spool(t);
    s.channel[kPressureB][k] = 60e5 + 2e5 * std::sin(9 * t);
    s.channel[kSupplyPressure][k] = 210e5;
    s.channel[kOilTemperature][k] = 313.15 + 2 * t;
  }
  return s;
}

/// A machine's samples `from` ... of a stretch, `count` of them.
inline Stretch PartOf(const Stretch& whole, int from, int count, bool continues) {
  Stretch part = whole;
  part.samples = count;
  part.continues = continues;
  part.begin = whole.begin + from * whole.period;
  for (std::size_t c = 0; c < whole.channel.size(); ++c)
    part.channel[c].assign(whole.channel[c].begin() + from, whole.channel[c].begin() + from + count);
  return part;
}

}  // namespace hydroscope
