#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "estimation/analytic_stroke.h"
#include "models/effect.h"
#include "simulator/effects.h"

namespace hydroscope {
namespace {

std::shared_ptr<const ModelStructure> Model() { return *BuildModel(AnalyticMachine()); }

/// One stretch with its derived channels.
Stretch SomeStretch(const ModelStructure& model) {
  AnalyticStroke stroke(0.2);
  Stretch s = SampleStroke(model, stroke, 200, 0.002);
  model.derive_channels(s);
  return s;
}

std::vector<double> Increments(const Column& column, const Stretch& s) {
  std::vector<double> out(s.samples - 1, std::nan(""));
  double state = 0;
  column.fill(s, state, out);
  return out;
}

TEST(Effects, AreThoseOfTheSimulator) {
  std::set<std::string> library, simulator;
  const auto model = Model();
  for (const auto& effect : model->effects) library.insert(effect->id);
  for (const EffectInfo& info : PressEffects()) simulator.insert(info.id);
  EXPECT_EQ(library, simulator);
}

TEST(Effects, EveryColumnIsFilledWithFiniteNumbers) {
  const auto model = Model();
  const Stretch s = SomeStretch(*model);
  for (const Column& column : model->columns)
    for (double x : Increments(column, s)) ASSERT_TRUE(std::isfinite(x)) << column.name;
}

TEST(Effects, EveryColumnStaysFiniteWithoutPressureWithoutOpeningAndAtTheStop) {
  const auto model = Model();
  Stretch s = SomeStretch(*model);
  for (int channel : {kPressureA, kPressureB, kPosition, kSpool})
    std::fill(s.channel[channel].begin(), s.channel[channel].end(), 0.0);
  model->derive_channels(s);
  for (const Column& column : model->columns)
    for (double x : Increments(column, s)) ASSERT_TRUE(std::isfinite(x)) << column.name;
  std::fill(s.channel[kPressureA].begin(), s.channel[kPressureA].end(), -2e5);
  model->derive_channels(s);
  for (const Column& column : model->columns)
    for (double x : Increments(column, s)) ASSERT_TRUE(std::isfinite(x)) << column.name;
}

/// A late signal is read ahead of its time, and the others behind theirs: beside the border of a stretch what
/// lies beyond it is not known.
bool LooksBeyond(const Column& column) { return column.name.find("_signal_delay") != std::string::npos; }

TEST(Effects, ColumnsGoOnOverTheBorderOfAStretch) {
  const auto model = Model();
  const Stretch all = SomeStretch(*model);
  const Stretch left = PartOf(all, 0, 100, false), right = PartOf(all, 99, 101, true);
  for (const Column& column : model->columns) {
    std::vector<double> whole(199), parts(199);
    double state = 0;
    column.fill(all, state, whole);
    state = 0;
    column.fill(left, state, std::span(parts).first(99));
    column.fill(right, state, std::span(parts).last(100));
    constexpr int kBeyond = 5;  // samples
    for (int k = 0; k < 199; ++k) {
      if (LooksBeyond(column) && std::abs(k - 99) <= kBeyond) continue;
      ASSERT_NEAR(whole[k], parts[k], 1e-12 * (std::abs(whole[k]) + 1e-3)) << column.name << " " << k;
    }
  }
}

TEST(Effects, StateLawSourceUnitRangeAndWhatToLookFor) {
  const auto model = Model();
  std::set<std::string> ids;
  for (const auto& e : model->effects) ids.insert(e->id);
  EXPECT_EQ(ids.size(), model->effects.size());
  for (const auto& e : model->effects) {
    EXPECT_FALSE(e->title.empty() || e->law.empty() || e->source.empty() || e->parameter.empty() ||
                 e->unit.empty())
        << e->id;
    EXPECT_LT(e->min, e->max) << e->id;
    EXPECT_GT(e->typical, e->min) << e->id;
    EXPECT_LT(e->typical, e->max) << e->id;
    EXPECT_THAT(e->plain, testing::AnyOf(testing::HasSubstr("look for"), testing::HasSubstr("Look for")))
        << e->id;
    for (const std::string& other : e->confused_with)
      EXPECT_EQ(ids.count(other), 1u) << e->id << " names " << other;
  }
}

TEST(Effects, EveryShapeHasOneFiniteWeightPerColumnAndValuesWithinItsRange) {
  const auto model = Model();
  ASSERT_EQ(model->effect_shapes.size(), model->effects.size());
  for (std::size_t i = 0; i < model->effects.size(); ++i) {
    const Effect& e = *model->effects[i];
    EXPECT_FALSE(model->effect_shapes[i].empty()) << e.id;
    for (const EffectShape& shape : model->effect_shapes[i]) {
      const auto weights = shape.weights({AnalyticStroke::Theta(), e.typical});
      ASSERT_EQ(weights.size(), shape.columns.size()) << e.id;
      for (double w : weights) EXPECT_TRUE(std::isfinite(w)) << e.id;
      for (int column : shape.columns) {
        EXPECT_GT(column, model->output_column()) << e.id;
        EXPECT_LT(column, model->column_count()) << e.id;
      }
      ASSERT_EQ(shape.nonlinear.size(), e.nonlinear.size()) << e.id;
      for (std::size_t k = 0; k < shape.nonlinear.size(); ++k) {
        EXPECT_GE(shape.nonlinear[k], e.nonlinear[k].min) << e.id;
        EXPECT_LE(shape.nonlinear[k], e.nonlinear[k].max) << e.id;
      }
    }
  }
}

}  // namespace
}  // namespace hydroscope
