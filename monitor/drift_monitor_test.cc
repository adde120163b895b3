#include "diagnosis/drift/drift_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/constants.h"
#include "studies/simulated_strokes.h"

namespace hydroscope::drift {
namespace {

/// What is learned from the strokes of a simulated press.
struct LearnedPress {
  std::vector<StrokeEvidence> strokes;
  std::optional<WatchedModel> model;
  std::optional<Reference> reference;

  static LearnedPress Simulated() {
    PressOptions options;
    options.seconds = 640;
    options.seed = 61;
    options.oil_start = 303.15;
    options.oil_end = 313.15;
    LearnedPress learned;
    const auto log = StrokesOf(SimulatePress(options), MachineFor(options));
    EXPECT_TRUE(log.has_value());
    if (!log) return learned;
    std::vector<std::string> names;
    for (const WatchSpec& watch : DefaultRules().watches) names.push_back(watch.quantity);
    auto model = WatchedModel::Create(log->model, names);
    EXPECT_TRUE(model.has_value());
    if (!model) return learned;
    for (const StrokeRecord& stroke : log->strokes)
      learned.strokes.push_back(model->Evidence(stroke, static_cast<std::int64_t>(learned.strokes.size())));
    auto reference = Reference::Learn(*model, learned.strokes, 1);
    EXPECT_TRUE(reference.has_value()) << (reference ? "" : reference.error().text);
    if (!reference) return learned;
    learned.model = std::move(*model);
    learned.reference = std::move(*reference);
    return learned;
  }
};

/// A monitor of its own for every test, and the strokes that it learned from, which are the same for all.
class DriftMonitorTest : public testing::Test {
 protected:
  void SetUp() override {
    static const LearnedPress learned = LearnedPress::Simulated();
    ASSERT_TRUE(learned.model && learned.reference);
    strokes_ = learned.strokes;
    monitor_.emplace(*learned.model, DefaultRules(), *learned.reference);
  }
  int IndexOf(const std::string& quantity) const {
    const auto& all = monitor_->model().quantities();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& q) { return q.name == quantity; });
    return static_cast<int>(found - all.begin());
  }
  /// A further stroke at which these quantities are off by so much (SI).
  void Add(const std::map<std::string, double>& off) {
    StrokeEvidence stroke = strokes_[static_cast<std::size_t>(added_) % strokes_.size()];
    stroke.sequence = static_cast<std::int64_t>(strokes_.size()) + added_++;
    Eigen::VectorXd less = Eigen::VectorXd::Zero(monitor_->model().size());
    for (const auto& [quantity, size] : off) less[IndexOf(quantity)] = -size;
    monitor_->Add(monitor_->reference().Without(monitor_->model(), stroke, less));
  }
  /// `count` further strokes over which an effect grows by `slope` (SI) a stroke.
  void Drift(const std::string& effect, double slope, std::int64_t count) {
    for (std::int64_t k = 0; k < count; ++k) Add({{effect, slope * static_cast<double>(k)}});
  }
  const DriftFinding* Found(const std::string& rule) const {
    for (const DriftFinding& finding : monitor_->findings())
      if (finding.rule == rule) return &finding;
    return nullptr;
  }

  std::vector<StrokeEvidence> strokes_;
  std::int64_t added_ = 0;
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

TEST_F(DriftMonitorTest, WhatIsNamedForLessFlowIsNotToldOfMore) {
  for (int k = 0; k < 60; ++k) Add({{"Q_vn", -1e-4}});
  ASSERT_NE(Found("clogged_valve"), nullptr);
  EXPECT_LT(Found("clogged_valve")->parts.front().size, 0);
  for (int k = 0; k < 2000 && Found("clogged_valve") != nullptr; ++k) {
    Add({{"Q_vn", 1e-4}});
    if (const DriftFinding* finding = Found("clogged_valve"); finding != nullptr) {
      EXPECT_LT(finding->parts.front().size, 0) << FindingText(*finding);
    }
  }
  EXPECT_EQ(Found("clogged_valve"), nullptr) << "it goes as one does that has become small";
  for (int k = 0; k < 60; ++k) Add({{"Q_vn", 1e-4}});
  EXPECT_NE(Found("worn_metering_edge"), nullptr);
}

TEST_F(DriftMonitorTest, BesideAChangeThatTheModelDoesNotDescribeNothingIsSure) {
  for (int k = 0; k < 60; ++k) Add({{"y_0", 0.02}});
  const DriftFinding* shift = Found("null_shift");
  ASSERT_NE(shift, nullptr);
  EXPECT_EQ(NameText(*shift).english, "Null of the valve has shifted");
  monitor_->TakeExplanation(
      shift->number,
      {.text = Told("the model errs more"), .described = false, .cause = {CauseKind::kNotKnown, {}}}, 24);
  EXPECT_EQ(NameText(*shift).english,
            "Change that the model does not describe; nearest: Null of the valve has shifted");
  for (int k = 0; k < 100; ++k) Add({{"y_0", 0.02}, {"internal_leakage", 5e-12}});
  const DriftFinding* leak = Found("internal_leakage");
  ASSERT_NE(leak, nullptr);
  EXPECT_FALSE(leak->described());
  ByteWriter saved;
  monitor_->Save(saved);
  const std::vector<std::uint8_t> bytes = saved.Take();
  ByteReader in(bytes);
  const auto restored = DriftMonitor::Restored(monitor_->model(), DefaultRules(), in);
  ASSERT_TRUE(restored.has_value());
  for (const DriftFinding& finding : restored->findings()) EXPECT_FALSE(finding.described());
}

TEST_F(DriftMonitorTest, BesideAChangeThatAnotherEffectMayExplainNothingIsSure) {
  for (int k = 0; k < 60; ++k) Add({{"y_0", 0.02}});
  const DriftFinding* shift = Found("null_shift");
  ASSERT_NE(shift, nullptr);
  monitor_->TakeExplanation(
      shift->number,
      {.text = Told("nearest: pressure_offset"), .cause = {CauseKind::kNotProven, {"pressure_offset"}}}, 24);
  EXPECT_EQ(NameText(*shift).english, "Null of the valve has shifted") << "what was measured stays its name";
  for (int k = 0; k < 100; ++k) Add({{"y_0", 0.02}, {"internal_leakage", 5e-12}});
  const DriftFinding* leak = Found("internal_leakage");
  ASSERT_NE(leak, nullptr);
  EXPECT_FALSE(leak->described());
}

TEST_F(DriftMonitorTest, ALeakageCannotBecomeLessThanNone) {
  Drift("internal_leakage", -kSlope, 6500);
  for (const SlowDrift& drift : monitor_->SlowDrifts()) EXPECT_NE(drift.quantity, "internal_leakage");
}

}  // namespace
}  // namespace hydroscope::drift
