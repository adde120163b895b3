#include "pipeline/stroke_overlays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

/// Overlays of one simulated log, and its strokes.
struct Pass {
  std::vector<StrokeSummary> strokes;
  std::vector<StrokeOverlay> chosen;
};

Pass PassPress(double min_stroke) {
  Pass pass;
  PressOptions press;
  press.seconds = 40;
  press.seed = 4;
  Machine machine = MachineFor(press);
  machine.gate.min_stroke = min_stroke;
  std::optional<StrokeOverlays> overlays;
  auto pipeline = Pipeline::Create(machine, press.sample_period, [&](StrokeRecord&& record) {
    pass.strokes.push_back(record.summary);
    overlays->AddStroke(record);
  });
  overlays.emplace(**pipeline);
  (*pipeline)->set_tap(
      [&](const Stretch&, const SpanEquations& equations) { overlays->AddFlows(equations); });
  (*pipeline)->Process(RowsOf(SimulatePress(press), machine));
  (*pipeline)->Finish();
  pass.chosen = overlays->Choose(100);
  return pass;
}

const StrokeSummary& StrokeOf(const Pass& pass, const StrokeOverlay& overlay) {
  return pass.strokes[static_cast<std::size_t>(overlay.sequence - 100)];
}

double Rms(const StrokeOverlay& overlay) {
  double squares = 0;
  for (std::size_t k = 0; k < overlay.time.size(); ++k)
    squares += std::pow(overlay.measured[k] - overlay.modelled[k], 2);
  return std::sqrt(squares / static_cast<double>(overlay.time.size()));
}

TEST(StrokeOverlays, ChosenStrokesAreWholeInOrderOfTimeAndModelledDownToTheNoise) {
  const Pass pass = PassPress(0.3);
  ASSERT_EQ(pass.chosen.size(), 2u);
  for (const StrokeOverlay& overlay : pass.chosen) {
    const StrokeSummary& stroke = StrokeOf(pass, overlay);
    ASSERT_GT(overlay.time.size(), 10u);
    EXPECT_EQ(overlay.measured.size(), overlay.time.size());
    EXPECT_EQ(overlay.modelled.size(), overlay.time.size());
    EXPECT_TRUE(std::is_sorted(overlay.time.begin(), overlay.time.end()));
    EXPECT_GE(overlay.time.front(), stroke.begin);
    EXPECT_LE(overlay.time.back(), stroke.end);
    EXPECT_GT(overlay.time.back() - overlay.time.front(), 0.7 * (stroke.end - stroke.begin));
    EXPECT_LT(Rms(overlay), 2 * overlay.noise_floor);
  }
  EXPECT_GE(Rms(pass.chosen[1]), Rms(pass.chosen[0])) << "the second is the worst";
}

TEST(StrokeOverlays, ADiscardedStrokeLeavesNothingInTheNextOne) {
  const Pass all = PassPress(0.3);
  std::vector<double> lengths;
  for (const StrokeSummary& s : all.strokes) lengths.push_back(s.end - s.begin);
  std::nth_element(lengths.begin(), lengths.begin() + lengths.size() / 2, lengths.end());
  const Pass some = PassPress(lengths[lengths.size() / 2]);
  ASSERT_LT(some.strokes.size(), all.strokes.size());
  ASSERT_FALSE(some.chosen.empty());
  for (const StrokeOverlay& overlay : some.chosen)
    EXPECT_GE(overlay.time.front(), StrokeOf(some, overlay).begin);
}

TEST(StrokeOverlays, WithoutStrokesThereIsNothingToShow) {
  const Pass none = PassPress(1000);
  EXPECT_TRUE(none.strokes.empty());
  EXPECT_TRUE(none.chosen.empty());
}

}  // namespace
}  // namespace hydroscope
