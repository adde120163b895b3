#include "diagnosis/drift/drift_monitor.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "studies/simulated_strokes.h"

namespace hydroscope::drift {
namespace {

/// A monitor that learned a simulated press, and the strokes it learned from.
class DriftMonitorTest : public testing::Test {
 protected:
  void SetUp() override {
    PressOptions options;
    options.seconds = 640;
    options.seed = 61;
    options.oil_start = 303.15;
    options.oil_end = 313.15;
    auto log = StrokesOf(SimulatePress(options), MachineFor(options));
    ASSERT_TRUE(log.has_value());
    std::vector<std::string> names;
    for (const WatchSpec& watch : DefaultRules().watches) names.push_back(watch.quantity);
    auto model = WatchedModel::Create(log->model, names);
    ASSERT_TRUE(model.has_value());
    for (const StrokeRecord& stroke : log->strokes)
      strokes_.push_back(model->Evidence(stroke, static_cast<std::int64_t>(strokes_.size())));
    auto reference = Reference::Learn(*model, strokes_, 1);
    ASSERT_TRUE(reference.has_value()) << (reference ? "" : reference.error().text);
    monitor_.emplace(std::move(*model), DefaultRules(), std::move(*reference));
  }
  int IndexOf(const std::string& quantity) const {
    const auto& all = monitor_->model().quantities();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& q) { return q.name == quantity; });
    return static_cast<int>(found - all.begin());
  }
  /// `count` further strokes over which an effect grows by `slope` (SI) a stroke.
  void Drift(const std::string& effect, double slope, std::int64_t count) {
    const int q = IndexOf(effect);
    for (std::int64_t k = 0; k < count; ++k) {
      StrokeEvidence stroke = strokes_[static_cast<std::size_t>(k) % strokes_.size()];
      stroke.sequence = static_cast<std::int64_t>(strokes_.size()) + k;
      stroke.equations.g += slope * static_cast<double>(k) * stroke.equations.h.col(q);
      monitor_->Add(stroke);
    }
  }

  std::vector<StrokeEvidence> strokes_;
  std::optional<DriftMonitor> monitor_;
};

constexpr double kSlope = 1e-16;  // m3/(s Pa) a stroke: 0.8 l/min at 200 bar within 6 500 strokes

TEST_F(DriftMonitorTest, ALeakageThatGrowsSlowlyIsASlowDriftWithItsTimeToTheLimit) {
  Drift("internal_leakage", kSlope, 6500);
  const auto drifts = monitor_->SlowDrifts();
  const auto leak = std::find_if(drifts.begin(), drifts.end(),
                                 [](const auto& d) { return d.quantity == "internal_leakage"; });
  ASSERT_NE(leak, drifts.end());
  EXPECT_NEAR(leak->figures.slope, kSlope, 0.1 * kSlope);
  EXPECT_GT(leak->limit, 0);
  EXPECT_GT(leak->reach.strokes, 10'000);
}

TEST_F(DriftMonitorTest, TheSizeOfALeakageThatGoesOnGrowingSaysHowFarItIsBehind) {
  constexpr double kFast = 200 * kSlope;
  constexpr int kStrokes = 250;
  Drift("internal_leakage", kFast, kStrokes);
  ASSERT_FALSE(monitor_->findings().empty());
  for (const DriftFinding& finding : monitor_->findings())
    for (const FindingPart& part : finding.parts) {
      EXPECT_EQ(part.quantity, "internal_leakage");
      EXPECT_NEAR(part.size, kFast * (kStrokes - 1), kNormal95 * part.std);
      EXPECT_LT(part.std, 0.25 * part.size);
    }
}

TEST_F(DriftMonitorTest, ALeakageCannotBecomeLessThanNone) {
  Drift("internal_leakage", -kSlope, 6500);
  for (const SlowDrift& drift : monitor_->SlowDrifts()) EXPECT_NE(drift.quantity, "internal_leakage");
}

}  // namespace
}  // namespace hydroscope::drift
