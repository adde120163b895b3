#include "estimation/closed_loop/closed_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.h"
#include "estimation/closed_loop/input_limit.h"
#include "machines/test_cylinder/kind.h"
#include "machines/test_cylinder/response.h"
#include "simulator/test_cylinder/test_cylinder.h"

namespace hydroscope {
namespace {

using ::testing::HasSubstr;

FrequencyRecord RecordOf(const TestCylinderOptions& o) {
  TestCylinderLog log = SimulateTestCylinder(o);
  return {o.sample_period, {{0, std::move(log.I_v), std::move(log.z), std::move(log.z_set)}}};
}
TransferModel ModelOf(const TestCylinderOptions& o) {
  return {&kTestCylinderPlant, {o.area}, o.sample_period};
}

TEST(ClosedLoop, TheTruthLiesInsideTheIntervalsAndNearTheValues) {
  const TestCylinderOptions o{.seconds = 40, .seed = 3};
  const auto response = MeasureClosedLoop(RecordOf(o), ModelOf(o));
  ASSERT_TRUE(response && response->fit) << (response ? response->no_fit.english : response.error().text);
  const TestCylinderTruth truth = TruthOf(o);
  const std::array<double, 5> values = {truth.f_h, truth.zeta_h, truth.f_sv, truth.K_sv, truth.T_d};
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR(response->parameters[i].value, values[i], 2.6 * response->parameters[i].std) << i;
  EXPECT_NEAR(response->parameters[0].value, 343, 0.015 * 343);
  EXPECT_NEAR(response->parameters[3].value, 0.0114, 0.01 * 0.0114);
  EXPECT_FALSE(response->input_limit);
  EXPECT_FALSE(response->dead_band);
  EXPECT_FALSE(response->readings_end);
  EXPECT_EQ(response->fit->inflation, 1);
}

TEST(ClosedLoop, AllStartsThatArePolishedEndInOneValley) {
  const TestCylinderOptions o{.seconds = 20, .seed = 1};
  const auto response = MeasureClosedLoop(RecordOf(o), ModelOf(o));
  ASSERT_TRUE(response && response->fit);
  EXPECT_EQ(response->fit->minima.size(), 1u);
}

TEST(ClosedLoop, TheDirectRatioIsBiasedWhereTheRatioOfCrossSpectraIsNot) {
  TestCylinderOptions o{.seconds = 60, .seed = 2};
  o.excitation /= 4;
  const auto response = MeasureClosedLoop(RecordOf(o), ModelOf(o), {.min_coherence = 0.3});
  ASSERT_TRUE(response);
  double direct = 0, ratio = 0;
  int count = 0;
  for (std::size_t i = 0; i < response->points.size(); ++i) {
    const FrequencyPoint& p = response->points[i];
    if (p.frequency < 2 || p.frequency > 10) continue;
    const std::complex<double> truth = ModelOf(o).Response(p.frequency, {343, 0.9766, 160, 0.0114, 0});
    direct += (response->direct[i] / truth).real() - 1;
    ratio += (p.response / truth).real() - 1;
    ++count;
  }
  ASSERT_GT(count, 5);
  EXPECT_LT(direct / count, -0.15);
  EXPECT_NEAR(ratio / count, 0, 0.1);
}

TEST(ClosedLoop, AHeldInputThatIsTakenForAnEvenOneBendsTheFigures) {
  const TestCylinderOptions o{.seconds = 20, .seed = 4};
  TransferModel even = ModelOf(o);
  even.hold = 0;
  const auto response = MeasureClosedLoop(RecordOf(o), even);
  ASSERT_TRUE(response && response->fit);
  EXPECT_GT(response->parameters[4].value, 80e-6) << "half a row of hold passes for a delay";
}

TEST(ClosedLoop, ADeadBandOfTheInputIsToldAndItsSizeFound) {
  const TestCylinderOptions o{.seconds = 20, .seed = 4};
  FrequencyRecord record = RecordOf(o);
  constexpr double kBand = 5e-4;  // A
  for (double& u : record.runs[0].input)
    u += u < 0 ? -kBand : kBand;  // what gets the plant to move as it did
  const auto response = MeasureClosedLoop(record, ModelOf(o));
  ASSERT_TRUE(response);
  ASSERT_TRUE(response->dead_band);
  EXPECT_NEAR(*response->dead_band, kBand, 0.05 * kBand);
  EXPECT_THAT(response->warnings.front().english, HasSubstr("as with a dead band of 0.0005 A of I_v"));
}

TEST(ClosedLoop, ReadingsOfTheInputThatEndAreToldAndNoDeadBand) {
  const TestCylinderOptions o{.seconds = 20, .seed = 4};
  FrequencyRecord record = RecordOf(o);
  EXPECT_FALSE(FindEndOfReadings(record));
  for (double& u : record.runs[0].input) u = std::clamp(u, -0.015, 0.015);
  const auto response = MeasureClosedLoop(record, ModelOf(o));
  ASSERT_TRUE(response);
  ASSERT_TRUE(response->readings_end);
  EXPECT_EQ(*response->readings_end, 0.015);
  EXPECT_FALSE(response->dead_band);
  EXPECT_THAT(response->warnings.front().english, HasSubstr("I_v never reads more than 0.015 A"));
}

TEST(ClosedLoop, TheReadingsOfASineDoNotEndAtItsPeaks) {
  FrequencyRecord record{1e-3, {SignalRun{}}};
  for (int k = 0; k < 20000; ++k)
    record.runs[0].input.push_back(1e-4 * std::round(1e4 * std::sin(0.0123 * k)));
  EXPECT_FALSE(FindEndOfReadings(record));
}

TEST(ClosedLoop, ADelayOfTheSensorIsFoundBesideTheOtherFigures) {
  TestCylinderOptions o{.seconds = 40, .seed = 5};
  o.sensor_delay = 50e-6;
  const auto response = MeasureClosedLoop(RecordOf(o), ModelOf(o));
  ASSERT_TRUE(response && response->fit);
  EXPECT_NEAR(response->parameters[4].value, 50e-6, 2.6 * response->parameters[4].std);
  EXPECT_NEAR(response->parameters[1].value, 0.9766, 0.03);
}

TEST(ClosedLoop, ACurrentThatDoesNotReachTheValveIsFoundAndLeftOut) {
  TestCylinderOptions o{.seconds = 40, .seed = 6};
  o.saturation = 0.014;
  const auto response = MeasureClosedLoop(RecordOf(o), ModelOf(o));
  ASSERT_TRUE(response && response->fit);
  ASSERT_TRUE(response->input_limit);
  EXPECT_NEAR(*response->input_limit, 0.014, 0.0015);
  EXPECT_NEAR(response->parameters[3].value, 0.0114, 0.015 * 0.0114);
}

TEST(ClosedLoop, MoreNoiseAsksForALongerRecord) {
  TestCylinderOptions o{.seconds = 30, .seed = 7};
  const auto quiet = MeasureClosedLoop(RecordOf(o), ModelOf(o));
  o.noise *= 5;
  o.disturbance *= 5;
  const auto loud = MeasureClosedLoop(RecordOf(o), ModelOf(o));
  ASSERT_TRUE(quiet && loud && loud->fit);
  EXPECT_GT(loud->seconds_needed, 4 * quiet->seconds_needed);
  EXPECT_GT(loud->seconds_needed, 60);
  ASSERT_FALSE(loud->warnings.empty());
  EXPECT_THAT(loud->warnings.front().english, HasSubstr("too short for the precision wanted"));
}

/// Of a logger that takes every second or eighth row of the controller.
TEST(ClosedLoop, RowsThatAreSlowerThanTheControllerGiveNoParameters) {
  TestCylinderOptions o{.seconds = 60, .seed = 3};
  const FrequencyRecord every = RecordOf(o);
  for (const std::size_t apart : {2, 8}) {
    FrequencyRecord record{static_cast<double>(apart) * o.sample_period, {{0, {}, {}, {}}}};
    const SignalRun& from = every.runs[0];
    SignalRun& to = record.runs[0];
    for (std::size_t row = 0; row < from.input.size(); row += apart) {
      to.input.push_back(from.input[row]);
      to.output.push_back(from.output[row]);
      to.set_point.push_back(from.set_point[row]);
    }
    TransferModel held = ModelOf(o);
    held.hold = record.sample_period;
    const auto response = MeasureClosedLoop(record, held);
    ASSERT_TRUE(response) << apart;
    EXPECT_FALSE(response->fit) << apart;
    EXPECT_TRUE(response->parameters.empty()) << apart;
    EXPECT_THAT(response->no_fit.english, HasSubstr("slower than the controller")) << apart;
    EXPECT_THAT(response->no_fit.english, HasSubstr("a resonance of the fixture")) << apart;
  }
}

TEST(ClosedLoop, WhatCannotBeMeasuredIsSaid) {
  const TestCylinderOptions o{.seconds = 10};
  FrequencyRecord still = RecordOf(o);
  std::fill(still.runs[0].set_point.begin(), still.runs[0].set_point.end(), 0.1);
  EXPECT_THAT(MeasureClosedLoop(still, ModelOf(o)).error().text, HasSubstr("z_set does not move"));

  FrequencyRecord other = RecordOf(o);
  TestCylinderOptions another = o;
  another.seed = 99;
  other.runs[0].set_point = SimulateTestCylinder(another).z_set;
  EXPECT_THAT(MeasureClosedLoop(other, ModelOf(o)).error().text, HasSubstr("not related"));

  FrequencyRecord brief = RecordOf(o);
  for (auto* signal : {&brief.runs[0].set_point, &brief.runs[0].input, &brief.runs[0].output})
    signal->resize(200);
  EXPECT_THAT(MeasureClosedLoop(brief, ModelOf(o)).error().text, HasSubstr("too short"));
  EXPECT_EQ(MeasureClosedLoop(brief, ModelOf(o), {.segment_length = 63}).error().kind, ErrorKind::kUsage);
}

TEST(ClosedLoop, PolesAreSharedOutAsTheyAreKnown) {
  TestCylinderOptions o{.seconds = 40, .seed = 8};
  o.trapped_air = 0.003;
  const auto response = MeasureClosedLoop(RecordOf(o), ModelOf(o), {.known = {343, 0.9766, 160, 0.0114, 0}});
  ASSERT_TRUE(response && response->fit);
  EXPECT_NEAR(response->parameters[0].value, TruthOf(o).f_h, 3 * response->parameters[0].std);
  EXPECT_NEAR(response->parameters[2].value, 160, 3 * response->parameters[2].std);
}

TEST(TestCylinderResponse, SharingOutThePolesLeavesTheResponse) {
  const std::vector<double> before = {240, 1.4, 300, 0.02, 0}, area = {1.3e-3};
  double damping = 0;
  for (int way = 0; way < 3; ++way) {
    std::vector<double> p = before;
    ASSERT_TRUE(ShareOutPoles(p, way));
    EXPECT_GT(p[1], damping) << "the least damping first";
    damping = p[1];
    for (const double f : {5.0, 80.0, 300.0, 900.0}) {
      const std::complex<double> s(0, kTwoPi * f);
      EXPECT_NEAR(std::abs(TestCylinderResponse(s, p, area) / TestCylinderResponse(s, before, area) - 1.0), 0,
                  1e-9);
    }
  }
  std::vector<double> light = {240, 0.4, 300, 0.02, 0};
  EXPECT_TRUE(ShareOutPoles(light, 0));
  EXPECT_EQ(light[0], 240);
  EXPECT_FALSE(ShareOutPoles(light, 1));
}

/// Why the parameters of a record of 20 s stay open.
std::string WhyOpen(TestCylinderOptions o) {
  o.seconds = 20;
  const auto response = MeasureClosedLoop(RecordOf(o), ModelOf(o));
  return response ? response->no_fit.english : response.error().text;
}

TEST(ClosedLoop, WhatHelpsWhereParametersStayOpenIsSaidByCause) {
  EXPECT_THAT(WhyOpen({.excitation = 2e-5}), HasSubstr("Excite the set point more strongly"));
  EXPECT_THAT(WhyOpen({.coulomb = 800}),
              HasSubstr("Where dry friction holds it, larger movements show more"));
}

}  // namespace
}  // namespace hydroscope
