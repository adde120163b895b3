#include "diagnosis/extended_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "diagnosis/effect_ranking.h"
#include "estimation/analytic_stroke_fixture.h"
#include "models/effect.h"

namespace hydroscope {
namespace {

int IndexOf(const ModelStructure& model, const std::string& id) {
  const auto at = std::find_if(model.effects.begin(), model.effects.end(),
                               [&](const auto& effect) { return effect->id == id; });
  return static_cast<int>(at - model.effects.begin());
}

TEST(ShapesFor, CorrectedSignalsBelongToTheCorrectionAtThatValue) {
  ModelStructure model = **BuildModel(AnalyticMachine());
  const int offset = IndexOf(model, "pressure_offset"), relief = IndexOf(model, "relief_valve");
  const EffectChoice here{offset, AddShape(model, offset, {6e5})}, elsewhere{offset, 0};
  const int on = AddShape(model, relief, {80e5}, Correction{offset, 6e5});
  const std::vector<int> alone = ShapesFor(model, relief, {});
  EXPECT_FALSE(alone.empty());
  EXPECT_EQ(std::count(alone.begin(), alone.end(), on), 0);
  EXPECT_EQ(ShapesFor(model, relief, std::array{here}), std::vector<int>{on});
  EXPECT_EQ(ShapesFor(model, relief, std::array{elsewhere}), alone);
}

TEST(CorrectionOf, IsTheFirstEffectThatActsOnSignals) {
  const ModelStructure model = **BuildModel(AnalyticMachine());
  const EffectChoice offset{IndexOf(model, "pressure_offset"), 0},
      delay{IndexOf(model, "spool_signal_delay"), 0}, leak{IndexOf(model, "internal_leakage"), 0};
  const std::array choices = {leak, delay, offset};
  const std::array<std::vector<double>, 3> values = {std::vector<double>{}, {0.006}, {6e5}};
  EXPECT_EQ(CorrectionOf(model, choices, values, 0), (Correction{delay.effect, 0.006}));
  EXPECT_EQ(CorrectionOf(model, choices, values, 1), std::nullopt);
  EXPECT_EQ(CorrectionOf(model, choices, values, 2), (Correction{delay.effect, 0.006}));
  EXPECT_EQ(CorrectionOf(model, std::span(choices).first(1), values, 0), std::nullopt);
}

/// An effect that explains all strokes evenly but for `left` noise variances of each.
RankedEffect Explaining(const ModelStructure& model, const std::string& id, double gain, double left) {
  RankedEffect ranked;
  ranked.id = id;
  ranked.effect = IndexOf(model, id);
  ranked.gain = gain;
  ranked.stands_out = ranked.significant = true;
  ranked.fit.excess = Eigen::VectorXd::LinSpaced(10, left, left + 1);
  ranked.fit.effects.emplace_back().choice = {ranked.effect, 0};
  return ranked;
}

/// Names that stay beside a leak that grows with the temperature and gains `more` than one that does not.
std::vector<std::string> BesideTheFreerLeak(double more) {
  auto model = std::make_shared<ModelStructure>(**BuildModel(AnalyticMachine()));
  AddSampleEffects(*model);
  const StrokeSet strokes(model, std::vector<StrokeGram>{}, WindowSamples::From(WindowSpec{}, 0.002));
  const ExplainOptions options;
  const std::vector<RankedEffect> ranking = {Explaining(*model, "leakage_temperature", 10000, 0),
                                             Explaining(*model, "internal_leakage", 10000 - more, more / 10),
                                             Explaining(*model, "orifice_leakage", 10000 - more, more / 10)};
  return EffectRanking(strokes, options, 1.0).Rivals({}, ranking, true);
}

TEST(EffectRanking, ASimplerLawStaysBesideAFreerOneThatHardlyGains) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(BesideTheFreerLeak(68), (Names{"leakage_temperature", "internal_leakage"}));
  EXPECT_EQ(BesideTheFreerLeak(72), Names{"leakage_temperature"});
}

}  // namespace
}  // namespace hydroscope
