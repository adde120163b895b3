#include "simulator/test_cylinder/test_cylinder.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <iterator>
#include <vector>

#include "core/constants.h"
#include "simulator/delay_line.h"
#include "simulator/random.h"
#include "simulator/ranges.h"
#include "simulator/test_cylinder/plant.h"

namespace hydroscope {
namespace {

/// Second-order section of a digital filter, y = b0 u + b1 u_1 + b2 u_2 - a1 y_1 - a2 y_2.
class FilterSection {
 public:
  FilterSection(std::array<double, 3> b, std::array<double, 2> a) : b_(b), a_(a) {}
  double operator()(double u) {
    const double y = b_[0] * u + b_[1] * u_[0] + b_[2] * u_[1] - a_[0] * y_[0] - a_[1] * y_[1];
    u_ = {u, u_[0]};
    y_ = {y, y_[0]};
    return y;
  }

 private:
  std::array<double, 3> b_;
  std::array<double, 2> a_;
  std::array<double, 2> u_{}, y_{};
};

/// White noise through sections one after the other.
class ColouredNoise {
 public:
  /// First-order low pass.
  static ColouredNoise LowPass(double corner_hz, double sample_period, std::uint64_t seed);
  /// Butterworth band pass of order 6, three sections (bilinear transform of low pass to band pass).
  static ColouredNoise BandPass(double low_hz, double high_hz, double sample_period, std::uint64_t seed);

  double Next();

 private:
  ColouredNoise(std::vector<FilterSection> sections, std::uint64_t seed)
      : sections_(std::move(sections)), random_(seed) {}

  std::vector<FilterSection> sections_;
  RandomStream random_;
};

using Pole = std::complex<double>;

/// Frequency of the analogue prototype that the bilinear transform puts at `hz`, rad per half sample.
double Warped(double hz, double sample_period) { return std::tan(kTwoPi / 2 * hz * sample_period); }

Pole Bilinear(Pole s) { return (1.0 + s) / (1.0 - s); }

ColouredNoise ColouredNoise::LowPass(double corner_hz, double sample_period, std::uint64_t seed) {
  const double pole = std::exp(-kTwoPi * corner_hz * sample_period);
  return {{FilterSection({1 - pole, 0, 0}, {-pole, 0})}, seed};
}

ColouredNoise ColouredNoise::BandPass(double low_hz, double high_hz, double sample_period,
                                      std::uint64_t seed) {
  const double low = Warped(low_hz, sample_period), high = Warped(high_hz, sample_period);
  const double width = high - low, centre = low * high;
  std::vector<FilterSection> sections;
  for (int k = 0; k < 2; ++k) {  // poles of order 3 with imaginary part >= 0; each gives two of the band pass
    const Pole prototype = std::polar(1.0, kTwoPi * (2.0 * k + 4) / 12) * width / 2.0;
    const Pole root = std::sqrt(prototype * prototype - centre);
    for (const Pole analogue : {prototype + root, prototype - root}) {
      if (k == 1 && analogue.imag() < 0) continue;  // the real pole's pair is conjugate
      const Pole z = Bilinear(analogue);
      // Zeros at 0 and half the sampling rate; gain 1 in the middle of the band.
      const Pole middle = Bilinear(Pole(0, std::sqrt(centre)));
      const double gain = std::abs((1.0 - z / middle) * (1.0 - std::conj(z) / middle)) /
                          std::abs(1.0 - 1.0 / (middle * middle));
      sections.emplace_back(std::array{gain, 0.0, -gain}, std::array{-2 * z.real(), std::norm(z)});
    }
  }
  return {std::move(sections), seed};
}

double ColouredNoise::Next() {
  double value = random_.Normal();
  for (FilterSection& section : sections_) value = section(value);
  return value;
}

constexpr double kLowCorner = 10, kBandLow = 150, kBandHigh = 450;  // Hz, the paper's sec. 3.2.1
constexpr double kSettled = 2;   // s of the loop before the log begins, and before amplitudes are measured
constexpr double kMeasured = 8;  // s over which they are

/// PID on the position.
class PositionController {
 public:
  explicit PositionController(const TestCylinderOptions& o)
      : o_(o), gain_(kTwoPi * o.crossover * o.area / o.K_sv) {}
  double Current(double set_point, double position) {
    const double error = set_point - position;
    if (o_.integral_time > 0) sum_ += error * o_.sample_period / o_.integral_time;
    const double slope = first_ ? 0 : (error - before_) / o_.sample_period;
    first_ = false;
    before_ = error;
    return gain_ * (error + sum_ + o_.derivative_time * slope);
  }

 private:
  const TestCylinderOptions& o_;
  double gain_, sum_ = 0, before_ = 0;
  bool first_ = true;
};

/// The closed loop, row by row.
class TestCylinderLoop {
 public:
  TestCylinderLoop(const TestCylinderOptions& o, double low, double high)
      : o_(o),
        low_(low),
        high_(high),
        plant_(o),
        controller_(o),
        delay_(o.sensor_delay, o.sample_period / kDelaySteps),
        low_noise_(ColouredNoise::LowPass(kLowCorner, o.sample_period, StreamSeed(o.seed, "low set point"))),
        high_noise_(ColouredNoise::BandPass(kBandLow, kBandHigh, o.sample_period,
                                            StreamSeed(o.seed, "high set point"))),
        disturbance_(
            ColouredNoise::LowPass(kLowCorner, o.sample_period, StreamSeed(o.seed, "valve disturbance"))),
        reading_(StreamSeed(o.seed, "position noise")) {
    const double pole = std::exp(-kTwoPi * kLowCorner * o.sample_period);
    disturbance_scale_ = o.disturbance * std::sqrt((1 + pole) / (1 - pole));
    delay_.Push(0);
  }

  /// At `time` s of the log.
  void Next(double time, double& set_point, double& current, double& position) {
    Drift(time);
    set_point = low_ * low_noise_.Next() + high_ * high_noise_.Next();
    position = (o_.sensor_delay > 0 ? delay_.Read() : plant_.position()) + o_.noise * reading_.Normal();
    current = controller_.Current(set_point, position);
    const double disturbed = current + disturbance_scale_ * disturbance_.Next();
    for (int k = 0; k < kDelaySteps; ++k) {
      plant_.Advance(disturbed, o_.sample_period / kDelaySteps);
      delay_.Push(plant_.position());
    }
  }

 private:
  static constexpr int kDelaySteps = 8;      // per row: a delay is interpolated between them
  static constexpr double kDriftStep = 0.1;  // s over which what drifts stands still

  void Drift(double time) {
    const TestCylinderDrift& d = o_.drift;
    if (time < std::max(d.from, drifted_ + kDriftStep)) return;
    if (d.f_h == 0 && d.zeta_h == 0 && d.f_sv == 0 && d.K_sv == 0) return;
    drifted_ = time;
    TestCylinderOptions now = o_;
    const double seconds = time - d.from;
    now.f_h *= 1 + d.f_h * seconds;
    now.zeta_h *= 1 + d.zeta_h * seconds;
    now.f_sv *= 1 + d.f_sv * seconds;
    now.K_sv *= 1 + d.K_sv * seconds;
    plant_.Become(now);
  }

  const TestCylinderOptions& o_;
  double low_, high_, disturbance_scale_ = 0, drifted_ = -1;
  TestCylinderPlant plant_;
  PositionController controller_;
  DelayLine delay_;
  ColouredNoise low_noise_, high_noise_, disturbance_;
  RandomStream reading_;
};

/// Standard deviation of the current with set points of these amplitudes and nothing else.
double CurrentOf(TestCylinderOptions o, double low, double high) {
  o.noise = o.disturbance = o.coulomb = o.saturation = 0;
  o.drift = {};
  TestCylinderLoop loop(o, low, high);
  double squares = 0, set_point = 0, current = 0, position = 0;
  const auto settled = static_cast<std::int64_t>(kSettled / o.sample_period);
  const auto rows = settled + static_cast<std::int64_t>(kMeasured / o.sample_period);
  for (std::int64_t row = 0; row < rows; ++row) {
    loop.Next(0, set_point, current, position);
    if (row >= settled) squares += current * current;
  }
  return std::sqrt(squares / static_cast<double>(rows - settled));
}

}  // namespace

Status Validate(const TestCylinderOptions& o) {
  if (const Status s = CheckRanges({{"f_h", o.f_h, 20, 1000, "Hz"},
                                    {"zeta_h", o.zeta_h, 0.02, 3, "1"},
                                    {"f_sv", o.f_sv, 10, 1000, "Hz"},
                                    {"K_sv", o.K_sv, 1e-4, 1, "m3/(s A)"},
                                    {"leak share", o.leak_share, 0, 1, "1"},
                                    {"seconds", o.seconds, 1, 1e5, "s"},
                                    {"sample period", o.sample_period, 5e-5, 1e-3, "s"},
                                    {"excitation", o.excitation, 0, 1, "A"},
                                    {"low share", o.low_share, 0, 1, "1"},
                                    {"noise", o.noise, 0, 1, "m"},
                                    {"disturbance", o.disturbance, 0, 1, "A"},
                                    {"crossover", o.crossover, 0.1, 30, "Hz"},
                                    {"integral time", o.integral_time, 0, 1e4, "s"},
                                    {"derivative time", o.derivative_time, 0, 0.01, "s"},
                                    {"Coulomb friction", o.coulomb, 0, 1e4, "N"},
                                    {"sensor delay", o.sensor_delay, 0, 5e-3, "s"},
                                    {"saturation", o.saturation, 0, 1, "A"},
                                    {"trapped air", o.trapped_air, 0, 0.5, "1"},
                                    {"specimen", o.specimen, 0, 1e9, "N/m"},
                                    {"leakage", o.leakage, 0, 1e-9, "m3/(s Pa)"},
                                    {"begin of the drift", o.drift.from, 0, 1e5, "s"}});
      !s)
    return s;
  constexpr double kMostDrift = 0.5;  // at the end of the log
  const double seconds = std::max(0.0, o.seconds - o.drift.from);
  for (const double rate : {o.drift.f_h, o.drift.zeta_h, o.drift.f_sv, o.drift.K_sv})
    TRY(CheckRanges({{"drift at the end of the log", rate * seconds, -kMostDrift, kMostDrift, "1"}}));
  return {};
}

TestCylinderLog SimulateTestCylinder(const TestCylinderOptions& o) {
  const double low = o.low_share * o.excitation,
               high = std::sqrt(1 - o.low_share * o.low_share) * o.excitation;
  const double unit = 1e-3;  // m, an amplitude that the loop answers in proportion
  TestCylinderLoop loop(o, low > 0 ? unit * low / CurrentOf(o, unit, 0) : 0,
                        high > 0 ? unit * high / CurrentOf(o, 0, unit) : 0);
  TestCylinderLog log;
  double set_point = 0, current = 0, position = 0;
  const auto settled = static_cast<std::int64_t>(kSettled / o.sample_period);
  const auto rows = static_cast<std::int64_t>(std::llround(o.seconds / o.sample_period));
  for (auto* column : {&log.t, &log.z_set, &log.I_v, &log.z}) column->reserve(static_cast<std::size_t>(rows));
  for (std::int64_t row = -settled; row < rows; ++row) {
    loop.Next(static_cast<double>(row) * o.sample_period, set_point, current, position);
    if (row < 0) continue;
    log.t.push_back(static_cast<double>(row) * o.sample_period);
    log.z_set.push_back(set_point);
    log.I_v.push_back(current);
    log.z.push_back(position);
  }
  return log;
}

TestCylinderTruth TruthOf(const TestCylinderOptions& o) {
  const TestCylinderPlant plant(o);
  const double K = 1 / (1 / plant.bulk_modulus() + o.trapped_air / (o.supply / 2));
  const double spring = o.volume / (4 * K * o.area * o.area);  // 1/(stiffness of the oil)
  // Denominator s (a s^2 + b s + c); a specimen with leakage would also move the pole from 0, which is left out.
  const double a = o.mass * spring;
  const double b = plant.friction() * spring + o.mass * plant.leakage() / (o.area * o.area);
  const double c = 1 + plant.friction() * plant.leakage() / (o.area * o.area) + o.specimen * spring;
  return {std::sqrt(c / a) / kTwoPi, b / (2 * std::sqrt(a * c)), o.f_sv, o.K_sv / c, o.sensor_delay};
}

std::string FormatTestCylinder(const TestCylinderLog& log) {
  std::string text = "t,z_set,I_v,z\n";
  const auto end = std::back_inserter(text);
  for (std::size_t k = 0; k < log.t.size(); ++k)
    fmt::format_to(end, FMT_COMPILE("{:.6f},{:.6f},{:.5f},{:.6f}\n"), log.t[k], 1e3 * log.z_set[k],
                   1e3 * log.I_v[k], 1e3 * log.z[k]);
  return text;
}

}  // namespace hydroscope
