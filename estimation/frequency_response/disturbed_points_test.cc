#include "estimation/frequency_response/disturbed_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "estimation/frequency_response/test_signals_fixture.h"

namespace hydroscope {
namespace {

using test_signals::Normal;

/// A second-order system, by short steps.
struct SecondOrderStep {
  double omega, damping, position = 0, speed = 0;
  double operator()(double input) {
    for (int step = 0; step < 20; ++step) {
      const double h = 1e-3 / 20;
      speed += h * omega * (omega * (input - position) - 2 * damping * speed);
      position += h * speed;
    }
    return position;
  }
};

/// 60 s of noise below some 40 Hz at 1 kHz through a valve of 80 Hz and damping 0.7. Both channels pick up lines of a hum,
/// the response `in_response` times as much of it as the command, which has `hum` of each.
FrequencyRecord NoiseWithHum(double hum, double in_response) {
  FrequencyRecord record{1e-3, {{}}};
  std::array<SecondOrderStep, 3> band = {
      {{2 * std::numbers::pi * 40, 0.6}, {2 * std::numbers::pi * 40, 0.6}, {2 * std::numbers::pi * 40, 0.6}}};
  SecondOrderStep valve{2 * std::numbers::pi * 80, 0.7};
  Normal normal(3);
  for (int n = 0; n < 60'000; ++n) {
    double command = normal(), lines = 0;
    for (SecondOrderStep& filter : band) command = filter(command);
    for (const double f : {57.0, 100.0, 150.0, 200.0, 250.0, 270.0})
      lines += hum * std::sin(2 * std::numbers::pi * f * n * 1e-3);
    const double position = valve(command);
    record.runs[0].input.push_back(command + lines + 1e-5 * normal());
    record.runs[0].output.push_back(position + in_response * lines + 1e-5 * normal());
  }
  return record;
}

TEST(DisturbedPoints, AHumThatBothChannelsPickUpDoesNotSpoilTheModel) {
  for (const double in_response : {0.5, 5.0}) {
    const auto response = MeasureFrequencyResponse(NoiseWithHum(4e-3, in_response));
    ASSERT_TRUE(response && response->model) << in_response;
    EXPECT_NEAR(response->model->natural_frequency.value, 80, 2) << in_response;
    EXPECT_NEAR(response->model->damping.value, 0.7, 0.03) << in_response;
    bool told = false;
    for (const Told& warning : response->warnings)
      told = told || warning.english.find("hum") != std::string::npos;
    EXPECT_TRUE(told) << in_response;
  }
}

TEST(DisturbedPoints, WithoutADisturbanceNoneIsLeftOut) {
  const auto response = MeasureFrequencyResponse(NoiseWithHum(0, 0));
  ASSERT_TRUE(response && response->model);
  for (const FrequencyPoint& p : response->points)
    EXPECT_NE(p.reason, PointReason::kDisturbed) << p.frequency;
}

/// A valve of 120 Hz swept by sines of which one, of 50 Hz, meets a hum of `hum` times its amplitude in the response.
FrequencyRecord SweepWithHum(double hum, std::uint64_t seed) {
  test_signals::Sweep sweep;
  sweep.f0 = 120;
  sweep.damping = 0.8;
  FrequencyRecord record = test_signals::Simulate(sweep, seed);
  std::vector<double>& response = record.runs[0].output;
  for (std::size_t n = 0; n < response.size(); ++n)
    response[n] +=
        hum * sweep.amplitude *
        std::sin(2 * std::numbers::pi * 50 * static_cast<double>(n) * 1e-3 + 0.7 * static_cast<double>(seed));
  return record;
}

int CountOff(const FrequencyResponse& response) {
  return static_cast<int>(
      std::ranges::count(response.points, PointReason::kOffTheOthers, &FrequencyPoint::reason));
}

TEST(DisturbedPoints, AHumOfJustAHeldFrequencyDoesNotSpoilTheModel) {
  for (const double hum : {0.02, 0.1, 0.4})
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto response = MeasureFrequencyResponse(SweepWithHum(hum, seed));
      ASSERT_TRUE(response && response->model) << hum;
      const ValueWithStd f0 = response->model->natural_frequency;
      EXPECT_NEAR(f0.value, 120, 3 * f0.std) << hum;
      EXPECT_LT(f0.std, 0.5) << hum;
      EXPECT_EQ(CountOff(*response), 1) << hum;
      EXPECT_THAT(InEnglish(response->warnings),
                  testing::Contains(testing::HasSubstr("hum of just this frequency")))
          << hum;
    }
}

TEST(DisturbedPoints, WhatADeadBandBendsIsNoHum) {
  for (const double band : {0.0005, 0.001, 0.002, 0.004, 0.008}) {
    FrequencyRecord record = SweepWithHum(0, 1);
    SecondOrderStep valve{2 * std::numbers::pi * 120, 0.8};
    Normal normal(5);
    for (std::size_t n = 0; n < record.runs[0].input.size(); ++n) {
      record.runs[0].output[n] = valve.position + 6.8e-5 * normal();
      const double u = record.runs[0].input[n];
      valve(u - std::clamp(u, -band, band));
    }
    const auto response = MeasureFrequencyResponse(record);
    ASSERT_TRUE(response) << band;
    EXPECT_EQ(CountOff(*response), 0) << band;
  }
}

TEST(DisturbedPoints, WithoutAHumNoHeldFrequencyIsOff) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto response = MeasureFrequencyResponse(SweepWithHum(0, seed));
    ASSERT_TRUE(response && response->model);
    EXPECT_EQ(CountOff(*response), 0) << seed;
  }
}

}  // namespace
}  // namespace hydroscope
