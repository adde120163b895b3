// Records that look like a valve check and are none: no figure is better than a wrong one.

#include "estimation/frequency_response/model_refusal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "estimation/frequency_response/test_signals_fixture.h"

namespace hydroscope {
namespace {

using test_signals::Normal;
using test_signals::Simulate;
using test_signals::Sweep;
using testing::HasSubstr;

constexpr double kStep = 1e-3;  // s

/// A valve by short steps, whose spool moves no faster than `fastest` strokes a second.
std::vector<double> SpoolOf(const std::vector<double>& command, double f0, double damping,
                            double fastest = std::numeric_limits<double>::infinity()) {
  constexpr int kSubsteps = 20;
  const double omega = 2 * std::numbers::pi * f0, h = kStep / kSubsteps;
  double position = 0, speed = 0;
  std::vector<double> spool;
  for (const double u : command) {
    spool.push_back(position);
    for (int k = 0; k < kSubsteps; ++k) {
      speed += h * omega * (omega * (u - position) - 2 * damping * speed);
      speed = std::clamp(speed, -fastest, fastest);
      position += h * speed;
    }
  }
  return spool;
}

FrequencyRecord Noisy(std::vector<double> command, std::vector<double> response) {
  Normal normal(5);
  for (double& y : response) y += 6.8e-5 * normal();
  return {kStep, {{0, std::move(command), std::move(response)}}, true};
}

std::vector<double> SweepCommand() { return Simulate({}, 1).runs[0].input; }

std::vector<double> NoiseCommand() {
  Normal normal(3);
  std::vector<double> command(30'000);
  for (double& u : command) u = 0.03 * normal();
  return command;
}

std::string ReasonOf(const FrequencyRecord& record) {
  const auto response = MeasureFrequencyResponse(record);
  if (!response) return response.error().text;
  EXPECT_TRUE(response->model.has_value() != !response->model_reason.empty());
  return response->model_reason.english;
}

TEST(ModelRefusal, AValveAsItShouldBeIsNotRefused) {
  const auto command = SweepCommand();
  EXPECT_EQ(ReasonOf(Noisy(command, SpoolOf(command, 120, 0.8))), "");
}

TEST(ModelRefusal, ASpoolAtItsHighestSpeedHasNoNaturalFrequency) {
  const auto command = SweepCommand();
  EXPECT_THAT(ReasonOf(Noisy(command, SpoolOf(command, 120, 0.8, 6))), HasSubstr("limit of speed"));
}

TEST(ModelRefusal, AValveThatChangesAmidTheSweepHasNone) {
  const auto command = SweepCommand();
  auto spool = SpoolOf(command, 120, 0.8);
  const auto worn = SpoolOf(command, 80, 0.8);
  std::copy(worn.begin() + 8000, worn.end(), spool.begin() + 8000);
  EXPECT_THAT(ReasonOf(Noisy(command, spool)), HasSubstr("changed amid the record"));
}

TEST(ModelRefusal, TheCommandOnceMoreIsNoResponse) {
  const auto command = SweepCommand();
  EXPECT_THAT(ReasonOf(Noisy(command, command)), HasSubstr("without any lag"));
  std::vector<double> late(command.size(), 0);
  std::copy(command.begin(), command.end() - 3, late.begin() + 3);
  EXPECT_THAT(ReasonOf(Noisy(command, late)), HasSubstr("without any lag"));
}

TEST(ModelRefusal, SizesThatNoValveHasAreAUnit) {
  const auto command = SweepCommand();
  auto spool = SpoolOf(command, 120, 0.8);
  FrequencyRecord slow = Noisy(command, spool);
  slow.sample_period = 1;
  EXPECT_THAT(ReasonOf(slow), HasSubstr("the time is not in the unit"));
  for (double& y : spool) y *= 100;
  FrequencyRecord percent = Noisy(command, spool);
  EXPECT_THAT(ReasonOf(percent), HasSubstr("a unit is not the one"));
  percent.shares = false;
  EXPECT_EQ(ReasonOf(percent), "");
}

TEST(ModelRefusal, AResponseThatIsLateByAShareOfASegmentIsNotTakenForAWeakerOne) {
  const auto command = NoiseCommand();
  const auto spool = SpoolOf(command, 80, 0.7);
  std::vector<double> late(spool.size(), 0);
  std::copy(spool.begin(), spool.end() - 200, late.begin() + 200);
  const auto prompt = MeasureFrequencyResponse(Noisy(command, spool));
  const auto response = MeasureFrequencyResponse(Noisy(command, late));
  ASSERT_TRUE(prompt && prompt->model && response && response->model);
  EXPECT_NEAR(response->model->gain.value, prompt->model->gain.value, 0.01);
  EXPECT_NEAR(response->model->natural_frequency.value, prompt->model->natural_frequency.value, 0.5);
  EXPECT_NEAR(response->model->dead_time.value - prompt->model->dead_time.value, 0.2, 1e-4);
}

}  // namespace
}  // namespace hydroscope
