#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "estimation/analytic_stroke_fixture.h"
#include "models/effect.h"
#include "simulator/die_cushion/effects.h"
#include "simulator/die_cushion/imperfections.h"

namespace hydroscope {
namespace {

/// The library in full: what stored Grams carry and what is tried where samples are at hand, in some shape.
std::shared_ptr<const ModelStructure> Model() {
  auto model = std::make_shared<ModelStructure>(**BuildModel(AnalyticMachine()));
  AddSampleEffects(*model);
  for (int e = 0; e < static_cast<int>(model->effects.size()); ++e)
    if (model->effects[e]->grid.empty()) AddShape(*model, e, {7.3, 0.4});
  return model;
}

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
  std::set<std::string> stored, simulator;
  const auto model = *BuildModel(AnalyticMachine());
  for (const auto& effect : model->effects) stored.insert(effect->id);
  for (const EffectInfo& info : PressEffects()) simulator.insert(info.id);
  EXPECT_EQ(stored, simulator);
  for (const ImperfectionInfo& info : PressImperfections()) simulator.insert(info.name);
  EXPECT_EQ(model->sample_effects.size(), 29u);
  for (const auto& effect : model->sample_effects) EXPECT_EQ(simulator.count(effect->id), 1u) << effect->id;
}

TEST(Effects, StoredGramsKeepTheirColumnsAndAModelWithAFurtherEffectHasItsColumnsBehind) {
  const auto plain = *BuildModel(AnalyticMachine());
  Machine machine = AnalyticMachine();
  machine.added_effects = {"K_drift"};
  const auto wide = *BuildModel(machine);
  const std::vector<std::string> before = plain->ColumnNames(), after = wide->ColumnNames();
  ASSERT_EQ(after.size(), before.size() + 2);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin()));
  EXPECT_EQ(plain->effects.size(), 18u);
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

/// A late signal is read ahead of its time, the others behind theirs, and a column of oil needs its time to
/// move: beside the border of a stretch what lies beyond it is not known.
int SamplesBeyond(const Column& column) {
  const auto is = [&](const char* effect) { return column.name.find(effect) != std::string::npos; };
  if (is("position_signal_lag")) return 90;  // 30 times the lag: a filter forgets its start slowly
  return is("_signal_delay") || is("line_inertance") ? 5 : 0;
}

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
    const int beyond = SamplesBeyond(column);
    for (int k = 0; k < 199; ++k) {
      if (beyond > 0 && std::abs(k - 99) <= beyond) continue;
      ASSERT_NEAR(whole[k], parts[k], 1e-11 * (std::abs(whole[k]) + 1e-3)) << column.name << " " << k;
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
                 e->unit.empty() || e->family.empty())
        << e->id;
    EXPECT_LT(e->min, e->max) << e->id;
    EXPECT_GT(e->typical, e->min) << e->id;
    EXPECT_LT(e->typical, e->max) << e->id;
    EXPECT_THAT(e->plain, testing::AnyOf(testing::HasSubstr("look for"), testing::HasSubstr("Look for")))
        << e->id;
    for (const std::string& other : e->confused_with)
      EXPECT_EQ(ids.count(other), 1u) << e->id << " names " << other;
    for (const Effect::Twin& twin : e->twins)
      EXPECT_EQ(ids.count(twin.id), 1u) << e->id << " has the twin " << twin.id;
    for (const std::vector<double>& at : e->grid) EXPECT_FALSE(e->where && e->where(at).empty()) << e->id;
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

/// What the balance without effects leaves.
std::vector<double> Left(const ModelStructure& model, const Stretch& s) {
  const Eigen::Vector4d theta = AnalyticStroke::Theta();
  std::vector<double> left = Increments(model.columns[model.output_column()], s);
  for (int c = 0; c < model.base_count; ++c) {
    const std::vector<double> column = Increments(model.columns[c], s);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= theta[c] * column[k];
  }
  return left;
}

std::vector<double> Added(const ModelStructure& model, int effect, int shape, double size, const Stretch& s) {
  const EffectShape& of = model.effect_shapes[effect][shape];
  const std::vector<double> weights = of.weights({AnalyticStroke::Theta(), size});
  std::vector<double> added(s.samples - 1, 0.0);
  for (std::size_t j = 0; j < weights.size(); ++j) {
    const std::vector<double> column = Increments(model.columns[of.columns[j]], s);
    for (std::size_t k = 0; k < added.size(); ++k) added[k] += size * weights[j] * column[k];
  }
  return added;
}

/// Root of the sum of squares, without the ends, beyond which a shifted signal is not known.
double Size(const std::vector<double>& x) {
  double sum = 0;
  for (std::size_t k = 30; k + 30 < x.size(); ++k) sum += x[k] * x[k];
  return std::sqrt(sum);
}

TEST(Effects, OfSignalsCorrectThemToWhatTheirColumnsSay) {
  ModelStructure model = *Model();
  const Stretch measured = SomeStretch(model);
  const std::map<std::string, double> values = {
      {"spool_signal_delay", 0.006},  {"pressure_signal_delay", 0.006}, {"position_signal_delay", 0.006},
      {"pressure_offset", 4e5},       {"valve_flow_curvature", 0.1},    {"spool_hysteresis", 0.01},
      {"tank_pressure", 4e5},         {"pressure_gain", 0.05},          {"pressure_offset_drift", 1e5},
      {"pressure_signal_lag", 0.006}, {"spool_signal_lag", 0.006},      {"position_signal_lag", 0.004}};
  std::size_t tested = 0;
  for (int e = 0; e < static_cast<int>(model.effects.size()); ++e) {
    const Effect& effect = *model.effects[e];
    if (!effect.correct) continue;
    ++tested;
    ASSERT_EQ(values.count(effect.id), 1u) << effect.id;
    const double value = values.at(effect.id);
    const int shape = AddShape(model, e, {value});
    ASSERT_NEAR(effect.implied({AnalyticStroke::Theta(), value}), value, 1e-12 * std::abs(value))
        << effect.id;
    Stretch corrected = measured;
    double state = 0;
    effect.correct(value, state, corrected);
    std::vector<double> added = Added(model, e, shape, value, measured);
    const std::vector<double> before = Left(model, measured), after = Left(model, corrected);
    const double whole = Size(added);
    for (std::size_t k = 0; k < added.size(); ++k) added[k] -= before[k] - after[k];
    EXPECT_LT(Size(added), 0.05 * whole) << effect.id;
  }
  EXPECT_EQ(tested, values.size());
}

TEST(Effects, CorrectWithinWhatIsKnownOfAStretch) {
  const auto model = Model();
  const Stretch known = SomeStretch(*model);
  Stretch longer = known;  // memory of a longer stretch, whose samples are none of this one
  for (std::vector<double>& x : longer.channel) x.insert(x.end(), 50, std::nan(""));
  for (const auto& effect : model->effects) {
    if (!effect->correct) continue;
    Stretch a = known, b = longer;
    double state_a = 0, state_b = 0;
    effect->correct(effect->typical, state_a, a);
    effect->correct(effect->typical, state_b, b);
    for (int c : {kPressureA, kPosition, kSpool, kFlowRoot, kPressureRate, kLogOpening})
      for (int k = 0; k < known.samples; ++k)
        ASSERT_EQ(a[c][k], b[c][k]) << effect->id << " " << c << " " << k;
  }
}

TEST(Effects, ActOnTheSignalsThatAnotherOneCorrects) {
  ModelStructure model = *Model();
  const Stretch measured = SomeStretch(model);
  const auto index = [&](const std::string& id) {
    for (std::size_t e = 0; e < model.effects.size(); ++e)
      if (model.effects[e]->id == id) return static_cast<int>(e);
    return -1;
  };
  const int offset = index("pressure_offset"), relief = index("relief_valve");
  const double crack = 80e5, b = 6e5;
  const int plain = AddShape(model, relief, {crack}), later = AddShape(model, relief, {crack + b}),
            on = AddShape(model, relief, {crack}, Correction{offset, b});
  // What opens at 80 bar opens at a reading of 86 bar, if the sensor reads 6 bar too much.
  const std::vector<double> expected = Added(model, relief, later, 1e-12, measured);
  std::vector<double> miss = Added(model, relief, on, 1e-12, measured);
  for (std::size_t k = 0; k < miss.size(); ++k) miss[k] -= expected[k];
  EXPECT_LT(Size(miss), 1e-9 * Size(expected));
  EXPECT_NE(Added(model, relief, plain, 1e-12, measured), expected);
  EXPECT_THAT(model.columns.back().name, testing::HasSubstr("after pressure_offset"));
}

}  // namespace
}  // namespace hydroscope
