#include "diagnosis/extended_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

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

}  // namespace
}  // namespace hydroscope
