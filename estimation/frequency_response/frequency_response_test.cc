#include "estimation/frequency_response/frequency_response.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <string>

#include "core/constants.h"
#include "estimation/frequency_response/test_signals_fixture.h"
#include "simulator/valve/valve_sweep.h"

namespace hydroscope {
namespace {

using test_signals::Normal;
using test_signals::Simulate;
using test_signals::Sweep;
using test_signals::TrueResponse;

ValveModel ModelOf(const Sweep& sweep, std::uint64_t seed = 1) {
  const auto response = MeasureFrequencyResponse(Simulate(sweep, seed));
  EXPECT_TRUE(response) << (response ? "" : response.error().text);
  EXPECT_TRUE(response && response->model) << (response ? response->model_reason.english : "");
  return response && response->model ? *response->model : ValveModel{};
}

void ExpectTruthInside(const Sweep& sweep, const ValveModel& m, double stds = 4) {
  EXPECT_NEAR(m.natural_frequency.value, sweep.f0, stds * m.natural_frequency.std);
  EXPECT_NEAR(m.damping.value, sweep.damping, stds * m.damping.std);
  EXPECT_NEAR(m.gain.value, sweep.gain, stds * m.gain.std);
  EXPECT_NEAR(m.dead_time.value, sweep.dead_time, stds * m.dead_time.std);
}

struct Coverage {
  int f0 = 0, damping = 0, gain = 0, dead_time = 0, bandwidth = 0, phase_90 = 0;
  double worst_f0 = 0;
};

Coverage CoverageOver(const Sweep& sweep, int seeds, const char* name) {
  const ValveModel truth = [&] {
    Sweep clean = sweep;
    clean.noise = clean.input_noise = 0;
    return ModelOf(clean);
  }();
  const auto inside = [](const ValueWithStd& v, double t) {
    return std::abs(v.value - t) <= kNormal95 * v.std ? 1 : 0;
  };
  Coverage c;
  for (int i = 0; i < seeds; ++i) {
    const ValveModel m = ModelOf(sweep, 1000 + i);
    c.f0 += inside(m.natural_frequency, sweep.f0);
    c.damping += inside(m.damping, sweep.damping);
    c.gain += inside(m.gain, sweep.gain);
    c.dead_time += inside(m.dead_time, sweep.dead_time);
    c.bandwidth += inside(m.bandwidth, truth.bandwidth.value);
    c.phase_90 += inside(m.phase_90, truth.phase_90.value);
    c.worst_f0 = std::max(c.worst_f0, std::abs(m.natural_frequency.value - sweep.f0));
  }
  std::printf(
      "%s: inside 95 %% intervals of %d: f0 %d, D %d, K_v %d, T_dead %d, -3 dB %d, -90 deg %d; worst f0 %.3g Hz\n",
      name, seeds, c.f0, c.damping, c.gain, c.dead_time, c.bandwidth, c.phase_90, c.worst_f0);
  return c;
}

void ExpectHonest(const Coverage& c, int seeds) {
  for (const int inside : {c.f0, c.damping, c.gain, c.dead_time, c.bandwidth, c.phase_90}) {
    EXPECT_GE(inside, 0.92 * seeds);
    EXPECT_LE(inside, 0.98 * seeds);
  }
}

TEST(FrequencyResponse, IntervalsOfThePublishedValveHoldTheTruthInNinetyFivePercentOfSweeps) {
  const Coverage c = CoverageOver({}, 200, "published valve, 1 kHz");
  ExpectHonest(c, 200);
  EXPECT_LT(c.worst_f0, 0.005 * 183.9);
}

TEST(FrequencyResponse, IntervalsHoldAtFiveKilohertz) {
  Sweep sweep;
  sweep.sampling = 5000;
  ExpectHonest(CoverageOver(sweep, 200, "5 kHz"), 200);
}

TEST(FrequencyResponse, IntervalsHoldForShortHolds) {
  Sweep sweep;
  sweep.sampling = 2000;
  sweep.hold = 0.4;
  ExpectHonest(CoverageOver(sweep, 200, "2 kHz, 0.4 s"), 200);
}

TEST(FrequencyResponse, IntervalsHoldWithANoisyCommand) {
  Sweep sweep;
  sweep.noise = 5e-4;
  sweep.input_noise = 2e-3;
  ExpectHonest(CoverageOver(sweep, 200, "noisy command"), 200);
}

void ExpectHeldCommandUnderstood(double update_rate, double sample_rate) {
  ValveSweepOptions options;
  options.update_rate = update_rate;
  options.sample_rate = sample_rate;
  options.dead_time = 0.3e-3;
  ValveSweepLog log = SimulateValveSweep(options);
  for (double& u : log.U_v) u /= 10;
  const FrequencyRecord record{1 / sample_rate, {{0, log.U_v, log.y_v}}};
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_TRUE(response && response->model);
  EXPECT_EQ(response->points.size(), 16u);
  EXPECT_EQ(response->model->command_hold, 1 / sample_rate);
  EXPECT_NEAR(response->model->natural_frequency.value, 183.9, 0.5);
  EXPECT_NEAR(response->model->damping.value, 0.6735, 0.002);
  EXPECT_NEAR(response->model->dead_time.value, 0.3e-3, 5e-6);
}

TEST(FrequencyResponse, ACommandHeldBetweenSamplesIsTakenIntoAccount) {
  ExpectHeldCommandUnderstood(1000, 1000);
}

TEST(FrequencyResponse, ACommandInStairsOfSeveralSamplesIsUnderstood) {
  ExpectHeldCommandUnderstood(1000, 5000);
}

TEST(FrequencyResponse, EveryPointOfTheSweepIsFoundWithItsFrequencyGainAndPhase) {
  const Sweep sweep;
  const auto response = MeasureFrequencyResponse(Simulate(sweep, 7));
  ASSERT_TRUE(response);
  EXPECT_EQ(response->method, FrequencyResponseMethod::kSine);
  ASSERT_EQ(response->points.size(), 16u);
  for (std::size_t k = 0; k < 16; ++k) {
    const FrequencyPoint& p = response->points[k];
    const auto truth = TrueResponse(sweep, sweep.frequencies[k]);
    EXPECT_EQ(p.reason, PointReason::kUsed);
    EXPECT_NEAR(p.frequency, sweep.frequencies[k], 1e-5);
    EXPECT_NEAR(p.gain(), std::abs(truth), 4.5 * p.GainStd());
    EXPECT_NEAR(p.phase, std::arg(truth), 4.5 * p.PhaseStd());
    EXPECT_NEAR(p.amplitude, 0.05, 1e-5);
    EXPECT_LT(p.GainStd(), 1e-4);
  }
}

TEST(FrequencyResponse, DeadTimeOfHalfAMillisecondIsFoundToFiftyMicroseconds) {
  Sweep sweep;
  sweep.dead_time = 0.5e-3;
  const ValveModel m = ModelOf(sweep);
  EXPECT_NEAR(m.dead_time.value, 0.5e-3, 0.05e-3);
  ExpectTruthInside(sweep, m);
}

TEST(FrequencyResponse, DampingFromResonantToOverdampedIsFound) {
  for (const double damping : {0.4, 0.6, 0.8, 1.0, 1.2}) {
    SCOPED_TRACE(damping);
    Sweep sweep;
    sweep.damping = damping;
    const ValveModel m = ModelOf(sweep);
    ExpectTruthInside(sweep, m);
    EXPECT_NEAR(m.natural_frequency.value, 183.9, 0.005 * 183.9);
  }
}

TEST(FrequencyResponse, FrequenciesThatAreMultiplesOfNothingAreFound) {
  Sweep sweep;
  sweep.frequencies = {83.37, 7.123, 41.7, 150.003, 12.9, 121.11, 27.77, 64.4};  // in no order either
  sweep.hold = 0.917;
  const auto response = MeasureFrequencyResponse(Simulate(sweep, 3));
  ASSERT_TRUE(response && response->model);
  ASSERT_EQ(response->points.size(), 8u);
  EXPECT_NEAR(response->points[0].frequency, 7.123, 1e-3);
  EXPECT_NEAR(response->points[7].frequency, 150.003, 1e-3);
  ExpectTruthInside(sweep, *response->model);
}

TEST(FrequencyResponse, PausesBetweenTheFrequenciesAreLeftOut) {
  Sweep sweep;
  sweep.pause = 0.3;
  sweep.input_noise = 1e-4;
  const auto response = MeasureFrequencyResponse(Simulate(sweep, 4));
  ASSERT_TRUE(response && response->model);
  EXPECT_EQ(response->method, FrequencyResponseMethod::kSine);
  EXPECT_EQ(response->points.size(), 16u);
  ExpectTruthInside(sweep, *response->model);
}

TEST(FrequencyResponse, TheTransientOfASlowSystemIsWaitedFor) {
  Sweep sweep;
  sweep.f0 = 8;
  sweep.damping = 0.2;  // decays with 0.1 s
  sweep.frequencies = {2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16};
  sweep.hold = 4;
  const auto response = MeasureFrequencyResponse(Simulate(sweep, 5));
  ASSERT_TRUE(response && response->model);
  ExpectTruthInside(sweep, *response->model);
  for (std::size_t k = 1; k < response->points.size(); ++k) EXPECT_GT(response->points[k].dropped, 0.5);
}

TEST(FrequencyResponse, AGapInTheLogCostsNothingButItsSamples) {
  const Sweep sweep;
  FrequencyRecord record = Simulate(sweep, 6);
  SignalRun& all = record.runs[0];
  SignalRun second{
      4.4, {all.input.begin() + 4400, all.input.end()}, {all.output.begin() + 4400, all.output.end()}};
  all.input.resize(4350);
  all.output.resize(4350);
  record.runs.push_back(second);
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_TRUE(response && response->model);
  EXPECT_EQ(response->points.size(), 17u);  // 50 Hz twice
  ExpectTruthInside(sweep, *response->model);
}

TEST(FrequencyResponse, DistortionOfASaturatedSpoolIsMeasured) {
  Sweep sweep;
  sweep.sampling = 5000;
  FrequencyRecord record = Simulate(sweep, 8);
  for (double& y : record.runs[0].output)
    y -= 40 * std::pow(y - sweep.offset, 3);  // third harmonic a^2 40/4 = 2.5 %
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_TRUE(response);
  EXPECT_NEAR(WorstDistortion(response->points), 0.0274, 0.002);
  EXPECT_EQ(WorstDistortion(MeasureFrequencyResponse(Simulate(sweep, 8))->points), 0);
}

TEST(FrequencyResponse, ReversedPolarityIsNamed) {
  Sweep sweep;
  FrequencyRecord record = Simulate(sweep, 9);
  for (double& y : record.runs[0].output) y = -y;
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_TRUE(response && response->model);
  EXPECT_NEAR(response->model->gain.value, -1.005, 0.001);
  EXPECT_NEAR(response->model->natural_frequency.value, 183.9, 0.5);
  ASSERT_FALSE(response->warnings.empty());
  EXPECT_NE(response->warnings[0].english.find("polarity"), std::string::npos);
}

TEST(FrequencyResponse, BroadbandNoiseIsEvaluatedByWelchAndHoldsTheTruth) {
  // Exact discrete response of the valve to a command that is held for ten samples of the simulation.
  int inside = 0, fits = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Normal normal(seed);
    const double f0 = 30, d = 0.7, step = 1e-4, w0 = 2 * std::numbers::pi * f0;
    double y = 0, v = 0, u = 0, low = 0;
    FrequencyRecord record{1e-3, {{}}};
    for (int n = 0; n < 600'000; ++n) {
      if (n % 10 == 0) low += 0.15 * (normal() - low);
      u = low;
      if (n % 10 ==
          9) {  // in the middle of the hold's effect: recorded half a period late, cancels the hold's delay
        record.runs[0].input.push_back(u + 1e-3 * normal());
        record.runs[0].output.push_back(y + 5e-3 * normal());
      }
      v += step * (w0 * w0 * (u - y) - 2 * d * w0 * v);
      y += step * v;
    }
    const auto response = MeasureFrequencyResponse(record);
    ASSERT_TRUE(response) << response.error().text;
    ASSERT_EQ(response->method, FrequencyResponseMethod::kWelch);
    ASSERT_TRUE(response->model);
    ++fits;
    inside += std::abs(response->model->natural_frequency.value - f0) < 0.02 * f0 &&
              std::abs(response->model->damping.value - d) < 0.03 * d;
  }
  EXPECT_EQ(inside, fits);
}

TEST(FrequencyResponse, NoiseAloneIsRefused) {
  Normal normal(1);
  FrequencyRecord record{1e-3, {{}}};
  for (int n = 0; n < 16'000; ++n) {
    record.runs[0].input.push_back(normal());
    record.runs[0].output.push_back(normal());
  }
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_FALSE(response);
  EXPECT_EQ(response.error().kind, ErrorKind::kBadInput);
  EXPECT_NE(response.error().text.find("not related"), std::string::npos) << response.error().text;
}

TEST(FrequencyResponse, ASweepWithoutAnyResponseIsRefused) {
  FrequencyRecord record = Simulate({}, 1);
  Normal normal(2);
  for (double& y : record.runs[0].output) y = 6.8e-5 * normal();
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_FALSE(response);
  EXPECT_NE(response.error().text.find("does not follow"), std::string::npos) << response.error().text;
}

TEST(FrequencyResponse, AConstantCommandAShortRecordAndADeadSensorAreNamed) {
  FrequencyRecord record = Simulate({}, 1);
  FrequencyRecord constant = record;
  std::fill(constant.runs[0].input.begin(), constant.runs[0].input.end(), 0.5);
  EXPECT_NE(MeasureFrequencyResponse(constant).error().text.find("constant"), std::string::npos);
  FrequencyRecord dead = record;
  std::fill(dead.runs[0].output.begin(), dead.runs[0].output.end(), 0.0);
  EXPECT_NE(MeasureFrequencyResponse(dead).error().text.find("response is constant"), std::string::npos);
  record.runs[0].input.resize(30);
  record.runs[0].output.resize(30);
  EXPECT_NE(MeasureFrequencyResponse(record).error().text.find("too short"), std::string::npos);
}

TEST(FrequencyResponse, AClippedResponseIsLeftOut) {
  FrequencyRecord record = Simulate({}, 1);
  for (double& y : record.runs[0].output) y = std::clamp(y, -0.03, 0.03);
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_FALSE(response);
  EXPECT_NE(response.error().text.find("clipped"), std::string::npos) << response.error().text;
}

TEST(FrequencyResponse, AChirpIsNoSteppedSine) {
  FrequencyRecord record{1e-3, {{}}};
  for (int n = 0; n < 60'000; ++n) {
    const double t = n * 1e-3;
    record.runs[0].input.push_back(std::sin(2 * std::numbers::pi * (0.5 * t + 0.3 * t * t)));
    record.runs[0].output.push_back(record.runs[0].input.back());
  }
  FrequencyResponseOptions sine;
  sine.method = FrequencyResponseMethod::kSine;
  const auto forced = MeasureFrequencyResponse(record, sine);
  ASSERT_FALSE(forced);
  EXPECT_NE(forced.error().text.find("no frequency is held"), std::string::npos) << forced.error().text;
  const auto automatic = MeasureFrequencyResponse(record);
  ASSERT_TRUE(automatic);
  EXPECT_EQ(automatic->method, FrequencyResponseMethod::kWelch);
}

TEST(FrequencyResponse, OptionsOutsideTheirLimitsAreNamed) {
  FrequencyResponseOptions options;
  options.segment_length = 33;
  EXPECT_EQ(options.Validate().error().kind, ErrorKind::kUsage);
  options = {};
  options.min_coherence = 1.5;
  EXPECT_NE(options.Validate().error().text.find("1.5"), std::string::npos);
  options = {};
  options.settle_time = -1;
  EXPECT_FALSE(options.Validate());
}

TEST(FrequencyResponse, TheValveCheckRecordHoldsTheModelAndItsConditions) {
  const auto response = MeasureFrequencyResponse(Simulate({}, 1));
  ASSERT_TRUE(response && response->model);
  const auto check = MakeValveCheck(*response, 12.5, 210e5, 318.15);
  ASSERT_TRUE(check);
  EXPECT_EQ(check->time, 12.5);
  EXPECT_EQ(check->natural_frequency.value, response->model->natural_frequency.value);
  EXPECT_NEAR(check->amplitude, 0.05, 1e-4);
  EXPECT_EQ(check->supply_pressure, 210e5);
  EXPECT_EQ(check->oil_temperature, 318.15);
  EXPECT_FALSE(MakeValveCheck(FrequencyResponse{}, 0, 0, 0));
}

TEST(FrequencyResponse, OnlyTheFrequenciesAskedForEnterTheModel) {
  const FrequencyRecord record = Simulate({}, 1);
  FrequencyResponseOptions options;
  options.lowest = 25;
  options.highest = 125;
  const auto response = MeasureFrequencyResponse(record, options);
  ASSERT_TRUE(response && response->model);
  EXPECT_EQ(response->points.size(), 16u);
  for (const FrequencyPoint& p : response->points) {
    const bool inside = p.frequency > 25 && p.frequency < 125;
    EXPECT_EQ(p.reason, inside ? PointReason::kUsed : PointReason::kOutsideRange) << p.frequency;
  }
  EXPECT_NEAR(response->model->lowest, 30, 1e-3);
  EXPECT_NEAR(response->model->highest, 120, 1e-3);
  ExpectTruthInside({}, *response->model);
  options.lowest = 170;
  EXPECT_EQ(options.Validate().error().kind, ErrorKind::kUsage);
  options.highest = 1e9;
  EXPECT_THAT(MeasureFrequencyResponse(record, options).error().text,
              testing::HasSubstr("no usable frequency lies within 170 to 1e9 Hz, 16 of 16 lie outside"));
}

/// Response and command of the measured press chirp; empty if the file is not there.
FrequencyRecord MeasuredChirp() {
  const char* folder = std::getenv("HYDROSCOPE_DATA");
  std::ifstream file((folder ? std::string(folder) : std::string(HYDROSCOPE_SOURCE_DIR) + "/../shared/data") +
                     "/servo_press_chirp/chirp_0A.txt");
  FrequencyRecord record{1e-3, {{}}};
  std::string line;
  for (int i = 0; i < 7; ++i) std::getline(file, line);
  while (std::getline(file, line)) {
    double displacement = 0, force = 0, command = 0;
    const std::size_t second = line.find(',', line.find(',') + 1);
    if (std::sscanf(line.c_str() + second + 1, "%lf, %lf, %lf", &displacement, &force, &command) != 3)
      continue;
    record.runs[0].input.push_back(command);
    record.runs[0].output.push_back(displacement);
  }
  if (record.runs[0].input.empty()) record.runs.clear();
  return record;
}

TEST(FrequencyResponse, TheMeasuredPressChirpGivesTheKnownResponse) {
  const FrequencyRecord record = MeasuredChirp();
  if (record.runs.empty()) GTEST_SKIP() << "servo_press_chirp/chirp_0A.txt is not there; set HYDROSCOPE_DATA";
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_TRUE(response) << response.error().text;
  EXPECT_EQ(response->method, FrequencyResponseMethod::kWelch);
  struct Known {
    double frequency, gain, phase;
  };
  for (const Known k :
       {Known{0.5, 0.995, -6.0}, {2, 0.953, -18.9}, {4.9, 0.826, -41.7}, {8.1, 0.674, -61.6}}) {
    const auto nearest =
        std::min_element(response->points.begin(), response->points.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.frequency - k.frequency) < std::abs(b.frequency - k.frequency);
        });
    EXPECT_NEAR(nearest->gain(), k.gain, 0.02 * k.gain);
    EXPECT_NEAR(nearest->phase * kDegrees, k.phase, 2);
  }
  for (const FrequencyPoint& p : response->points) {
    if (p.frequency > 25) {
      EXPECT_EQ(p.reason, PointReason::kLowCoherence) << p.frequency;
    }
    if (p.frequency < 20) {
      EXPECT_EQ(p.reason, PointReason::kUsed) << p.frequency;
    }
  }
  ASSERT_TRUE(response->model);
  EXPECT_GT(response->model->bandwidth.value, 7);
  EXPECT_LT(response->model->bandwidth.value, 8);
  for (const FrequencyPoint& p : response->points) {
    if (p.frequency > 15) continue;
    EXPECT_NEAR(std::abs(response->model->Response(p.frequency)), p.gain(), 0.03) << p.frequency;
    EXPECT_NEAR(response->model->Phase(p.frequency), p.phase, 3 / kDegrees) << p.frequency;
  }
}

/// A chirp up to 20 Hz through a valve of 30 Hz, and a disturbance that the cards of both channels pick up,
/// a thousandth of the command: coherent where there is nothing to measure.
TEST(FrequencyResponse, CoherentFrequenciesWithoutPowerDoNotSpoilTheModel) {
  FrequencyRecord record{1e-3, {{}}};
  const double omega_0 = 2 * std::numbers::pi * 30, damping = 0.7;
  Normal normal(1);
  double position = 0, speed = 0;
  for (int n = 0; n < 60'000; ++n) {
    const double t = n * 1e-3, rate = 20.0 / 60;
    const double command = std::sin(std::numbers::pi * rate * t * t);
    double hum = 0;
    for (const double f : {57.0, 130.0, 180.0, 270.0}) hum += 1e-3 * std::sin(2 * std::numbers::pi * f * t);
    record.runs[0].input.push_back(command + hum + 1e-5 * normal());
    record.runs[0].output.push_back(position + 2 * hum + 1e-5 * normal());
    for (int step = 0; step < 20; ++step) {
      const double h = 1e-3 / 20;
      speed += h * omega_0 * (omega_0 * (command - position) - 2 * damping * speed);
      position += h * speed;
    }
  }
  const auto response = MeasureFrequencyResponse(record);
  ASSERT_TRUE(response && response->model);
  for (const FrequencyPoint& p : response->points) {
    if (p.frequency > 25) {
      EXPECT_NE(p.reason, PointReason::kUsed) << p.frequency;
    }
  }
  EXPECT_NEAR(response->model->natural_frequency.value, 30, 1);
  EXPECT_NEAR(response->model->damping.value, 0.7, 0.05);
  ASSERT_FALSE(response->warnings.empty());
  EXPECT_NE(response->warnings[0].english.find("hardly any power"), std::string::npos)
      << response->warnings[0].english;
}

}  // namespace
}  // namespace hydroscope
