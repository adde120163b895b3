#include "diagnosis/sample_grams.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "diagnosis/simulated_log_fixture.h"
#include "models/effect.h"

namespace hydroscope {
namespace {

/// With one more shape of each effect whose law has values to be found; `walk`: those of which columns walk, or the others.
std::shared_ptr<const ModelStructure> Grown(const ModelStructure& model, bool walk) {
  auto grown = std::make_shared<ModelStructure>(model);
  for (std::size_t e = 0; e < model.effects.size(); ++e)
    if (!model.effects[e]->grid.empty() && model.effects[e]->walks == walk)
      AddShape(*grown, static_cast<int>(e), model.effects[e]->grid.front());
  return grown;
}

/// What is integrated walks, and columns that do not are without that noise: both ways of forming their Grams must agree on it.
TEST(GrowingGrams, AreThoseOfTheWholeModelToTheBit) {
  PressOptions options;
  options.seconds = 12;
  const SimulatedStrokes log = StrokesOfPress(options);
  const auto base = std::make_shared<const ModelStructure>(BaseOnly(*log.model));
  for (const auto& first : {base, log.model}) {
    const GrowingGrams growing(first, log.strokes, log.window);
    const auto walking = Grown(*first, true), still = Grown(*first, false);
    ASSERT_GT(std::min(walking->column_count(), still->column_count()), first->column_count());
    for (const auto& model : {first, walking, still}) {
      const std::vector<StrokeGram> expected = GramsOf(model, log.strokes, log.window),
                                    grams = growing.Of(model);
      ASSERT_GT(grams.size(), 1u);
      ASSERT_EQ(grams.size(), expected.size());
      for (std::size_t s = 0; s < grams.size(); ++s) {
        EXPECT_EQ(grams[s].integral, expected[s].integral);
        EXPECT_EQ(grams[s].noise, expected[s].noise);
        EXPECT_EQ(grams[s].flow, expected[s].flow);
        EXPECT_EQ(grams[s].blocks, expected[s].blocks);
        EXPECT_EQ(grams[s].spans, expected[s].spans);
        EXPECT_EQ(grams[s].windows, expected[s].windows);
      }
    }
  }
}

}  // namespace
}  // namespace hydroscope
