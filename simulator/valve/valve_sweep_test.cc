#include "simulator/valve/valve_sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace hydroscope {
namespace {

/// Gain and phase at one frequency by correlation over the second half of its hold of `hold` s.
std::complex<double> Response(const ValveSweepLog& log, double f, double begin, double hold) {
  std::complex<double> input, output;
  for (std::size_t k = 0; k < log.t.size(); ++k) {
    if (log.t[k] < begin + hold / 2 - 1e-9 || log.t[k] >= begin + hold - 1e-9) continue;
    const std::complex<double> turn = std::polar(1.0, -2 * std::numbers::pi * f * log.t[k]);
    input += turn * log.U_v[k] / 10.0;
    output += turn * log.y_v[k];
  }
  return output / input;
}

TEST(ValveSweep, SteadyStateHasTheAnalyticGainAndPhase) {
  ValveSweepOptions options;
  options.noise = 0;
  options.dead_time = 7.3e-4;
  const ValveSweepLog log = SimulateValveSweep(options);
  ASSERT_EQ(log.t.size(), 16000u);
  for (int k = 0; k < 16; ++k) {
    const double f = 10 * (k + 1), ratio = f / options.f0;
    const std::complex<double> expected =
        options.gain / std::complex<double>(1 - ratio * ratio, 2 * options.damping * ratio) *
        std::polar(1.0, -2 * std::numbers::pi * f * options.dead_time);
    EXPECT_LT(std::abs(Response(log, f, k, 1.0) - expected), 1e-5) << f << " Hz";
  }
}

TEST(ValveSweep, NoiseHasTheAskedSizeAndSeed) {
  ValveSweepOptions options;
  ValveSweepOptions silent = options;
  silent.noise = 0;
  options.noise = 1e-3;
  const ValveSweepLog a = SimulateValveSweep(options), b = SimulateValveSweep(silent);
  double sum = 0;
  for (std::size_t k = 0; k < a.t.size(); ++k) sum += std::pow(a.y_v[k] - b.y_v[k], 2);
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(a.t.size())), 1e-3, 3e-5);
  EXPECT_EQ(a.y_v, SimulateValveSweep(options).y_v);
  options.seed = 2;
  EXPECT_NE(a.y_v, SimulateValveSweep(options).y_v);
}

TEST(ValveSweep, HeldCommandIsLateByHalfItsPeriod) {
  ValveSweepOptions options;
  options.noise = 0;
  options.frequencies = {20};
  options.sample_rate = 10000;
  options.update_rate = 1000;
  const ValveSweepLog held = SimulateValveSweep(options);
  options.update_rate = 0;
  const ValveSweepLog smooth = SimulateValveSweep(options);
  std::complex<double> a, b;
  for (std::size_t k = 5000; k < 10000; ++k) {
    const auto turn = std::polar(1.0, -2 * std::numbers::pi * 20 * held.t[k]);
    a += turn * held.y_v[k];
    b += turn * smooth.y_v[k];
  }
  EXPECT_NEAR(std::arg(a / b), -2 * std::numbers::pi * 20 * 0.0005, 1e-4);
}

TEST(ValveSweep, FrequencyAboveHalfTheSampleRateIsRefusedWithItsLimit) {
  ValveSweepOptions options;
  options.frequencies = {600};
  const Status status = Validate(options);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text.find("600"), std::string::npos);
  EXPECT_NE(status.error().text.find("500"), std::string::npos);
}

TEST(ValveSweep, FileHasHeaderAndOneLinePerRow) {
  ValveSweepOptions options;
  options.frequencies = {10};
  options.hold = 0.1;
  const std::string text = FormatValveSweep(SimulateValveSweep(options));
  EXPECT_EQ(text.substr(0, 10), "t,U_v,y_v\n");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 101);
}

}  // namespace
}  // namespace hydroscope
