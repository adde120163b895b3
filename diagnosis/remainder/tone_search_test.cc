#include "diagnosis/remainder/tone_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "estimation/analytic_stroke_fixture.h"

namespace hydroscope {
namespace {

constexpr double kRate = 500;  // samples a second
constexpr int kStrokes = 10;

struct ToneLog {
  std::shared_ptr<const ModelStructure> model = *BuildModel(AnalyticMachine());
  std::vector<StrokeStretches> strokes;
  Eigen::VectorXd weights;
};

/// Strokes of the analytic machine at irregular times, in spans of 0.4 s, with noise of the position and what
/// `extra` adds to it, m: a function of the time of the log and of that since the stroke began, s.
template <typename Extra>
ToneLog LogWith(Extra extra) {
  ToneLog log;
  log.weights = Eigen::VectorXd::Zero(log.model->column_count());
  log.weights.head(4) = AnalyticStroke::Theta();
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 1.2e-4);
  double begin = 0;
  for (int k = 0; k < kStrokes; ++k) {
    AnalyticStroke stroke(0.2);
    StrokeStretches stretches;
    for (int part = 0; part < 4; ++part) {
      if (part > 0) stroke.Advance(1 / kRate);
      Stretch s = SampleStroke(*log.model, stroke, 200, 1 / kRate);
      s.begin = begin + part * 200 / kRate;
      for (int i = 0; i < s.samples; ++i)
        s.channel[kPosition][i] += noise(random) + extra(s.begin + i / kRate, part * 0.4 + i / kRate);
      stretches.push_back(std::move(s));
    }
    log.strokes.push_back(std::move(stretches));
    begin += 3.1 + 0.37 * (k % 4) + 0.113 * k;
  }
  return log;
}

TEST(ToneSearch, FindsNothingInNoise) {
  const ToneLog log = LogWith([](double, double) { return 0.0; });
  EXPECT_FALSE(FindTone(*log.model, log.strokes, log.weights));
}

TEST(ToneSearch, FindsFrequencyPhaseAndAmplitudeOfARippleOfTheFlow) {
  // A flow a sin(omega t + phase) moves the position by -a / (omega A) cos(omega t + phase).
  constexpr double kFrequency = 7.3, kAmplitude = 5e-5, kPhase = 0.7;
  const double omega = 2 * std::numbers::pi * kFrequency;
  const ToneLog log = LogWith([&](double t, double) {
    return -kAmplitude / (omega * AnalyticStroke::kArea) * std::cos(omega * t + kPhase);
  });
  const auto tone = FindTone(*log.model, log.strokes, log.weights);
  ASSERT_TRUE(tone);
  EXPECT_NEAR(tone->frequency, kFrequency, 0.005);
  EXPECT_NEAR(tone->amplitude, kAmplitude, 0.15 * kAmplitude);
  EXPECT_NEAR(std::remainder(tone->phase - kPhase, 2 * std::numbers::pi), 0, 0.25);
}

TEST(ToneSearch, WhatEveryStrokeRepeatsFromItsBeginningIsNoTone) {
  const double omega = 2 * std::numbers::pi * 7.3;
  const ToneLog log = LogWith([&](double, double since) { return 1e-4 * std::cos(omega * since); });
  EXPECT_FALSE(FindTone(*log.model, log.strokes, log.weights));
}

TEST(ToneSearch, AddsTheShapeToTheEffectThatHasNoGrid) {
  const double omega = 2 * std::numbers::pi * 11.0;
  const ToneLog log = LogWith([&](double t, double) { return 1e-4 * std::cos(omega * t); });
  ModelStructure wide = *log.model;
  AddSampleEffects(wide, {"periodic_disturbance"});
  ASSERT_TRUE(wide.effect_shapes.back().empty());
  ASSERT_TRUE(AddSearchedShapes(wide, log.strokes, log.weights));
  ASSERT_EQ(wide.effect_shapes.back().size(), 1u);
  EXPECT_NEAR(wide.effect_shapes.back().front().nonlinear.front(), 11.0, 0.005);
}

}  // namespace
}  // namespace hydroscope
