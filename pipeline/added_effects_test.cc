#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/added_effects_estimator.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

PressOptions Leaking(std::uint64_t seed = 7) {
  PressOptions press;
  press.seconds = 90;
  press.seed = seed;
  press.effects = {{"internal_leakage", 6e-12, {}}};
  return press;
}

Machine WithLeak(const PressOptions& press) {
  Machine machine = MachineFor(press);
  machine.added_effects = {"internal_leakage"};
  return machine;
}

std::vector<StrokeRecord> Replay(const Machine& machine, const SampleBlock& rows,
                                 const std::vector<std::uint8_t>& state = {},
                                 std::vector<std::uint8_t>* left = nullptr) {
  std::vector<StrokeRecord> records;
  auto pipeline =
      Pipeline::Create(machine, 0.002, [&](StrokeRecord&& r) { records.push_back(std::move(r)); });
  EXPECT_TRUE(pipeline.has_value());
  if (!state.empty()) {
    const Status restored = (*pipeline)->RestoreState(state);
    EXPECT_TRUE(restored.has_value());
  }
  (*pipeline)->Process(rows);
  (*pipeline)->Finish();
  if (left != nullptr) *left = (*pipeline)->SaveState();
  return records;
}

const Estimate* Find(const StrokeRecord& record, const std::string& name) {
  for (const Estimate& e : record.estimates)
    if (e.parameter == name) return &e;
  return nullptr;
}

TEST(AddedEffects, AreIdentifiedWithTheBaseModelStrokeByStroke) {
  const PressOptions press = Leaking();
  const auto records = Replay(WithLeak(press), RowsOf(SimulatePress(press), WithLeak(press)));
  ASSERT_GT(records.size(), 6u);
  EXPECT_TRUE(records[0].estimates.empty()) << "the first strokes give the point to start from";
  const Estimate* leak = Find(records.back(), "internal_leakage.G");
  ASSERT_NE(leak, nullptr);
  EXPECT_NEAR(leak->value, 6e-12, 4 * leak->std);
  EXPECT_LT(leak->std, 2e-12);
  EXPECT_EQ(leak->unit, "m3/(s Pa)");
  EXPECT_EQ(leak->reason, EstimateReason::kUpdated) << "given the others, every stroke tells about a leak";
  EXPECT_EQ(Find(records.back(), "Q_vn")->reason, EstimateReason::kUpdated);
}

TEST(AddedEffects, LowerTheErrorOfEveryStrokeAndLeaveItsGramAsItIs) {
  const PressOptions press = Leaking();
  const Machine base = MachineFor(press), extended = WithLeak(press);
  const SampleBlock rows = RowsOf(SimulatePress(press), base);
  const auto without = Replay(base, rows), with = Replay(extended, rows);
  ASSERT_EQ(without.size(), with.size());
  EXPECT_LT(with.back().summary.rms_error, without.back().summary.rms_error);
  for (std::size_t k = 0; k < with.size(); ++k) EXPECT_EQ(with[k].gram.integral, without[k].gram.integral);
}

TEST(AddedEffects, AValueOfTheMachineFileNeedsNoFurtherColumnInTheRecord) {
  const PressOptions press = Leaking();
  Machine machine = WithLeak(press);
  machine.added_effects = {"relief_valve"};
  machine.effect_values["relief_valve"]["p_crack"] = 1.55e7;
  const auto records = Replay(machine, RowsOf(SimulatePress(press), machine));
  const auto plain = Replay(MachineFor(press), RowsOf(SimulatePress(press), machine));
  EXPECT_EQ(records[0].gram.flow, plain[0].gram.flow);
}

TEST(AddedEffects, ThatStoredStrokesHaveNoColumnsOfAreIdentifiedWithTheirOwn) {
  PressOptions press;
  press.seconds = 90;
  press.seed = 9;
  press.imperfections = {{"return_line_resistance", 1e9, {}, ""}};
  Machine machine = MachineFor(press);
  const auto plain = Replay(machine, RowsOf(SimulatePress(press), machine));
  machine.added_effects = {"return_line_resistance"};
  machine.effect_values["return_line_resistance"]["x"] =
      1e9 * press.machine.Q_vn / std::sqrt(press.machine.dp_nom);
  const auto records = Replay(machine, RowsOf(SimulatePress(press), machine));
  ASSERT_EQ(records.size(), plain.size());
  const Estimate* size = Find(records.back(), "return_line_resistance.R_1");
  ASSERT_NE(size, nullptr);
  EXPECT_NEAR(size->value, 1e9, 4 * size->std);
  EXPECT_LT(size->std, 1e8);
  EXPECT_LT(records.back().summary.rms_error, plain.back().summary.rms_error);
  EXPECT_GT(records[0].gram.flow.dimension(), plain[0].gram.flow.dimension());
}

TEST(AddedEffects, ADriftRunsWithTheTimeSinceTheBeginning) {
  PressOptions press;
  press.seconds = 120;
  press.seed = 10;
  press.imperfections = {{"Q_vn_drift", 0.06, {}, ""}};
  Machine machine = MachineFor(press);
  machine.added_effects = {"Q_vn_drift"};
  const auto records = Replay(machine, RowsOf(SimulatePress(press), machine));
  const Estimate* rate = Find(records.back(), "Q_vn_drift.d");
  ASSERT_NE(rate, nullptr);
  EXPECT_NEAR(rate->value, 0.06 / 120, 4 * rate->std + 2e-5);
  EXPECT_LT(rate->std, 1e-4);
}

TEST(AddedEffects, TheNextLogStartsFromTheStateOfTheOneBefore) {
  const PressOptions press = Leaking();
  const Machine machine = WithLeak(press);
  std::vector<std::uint8_t> state;
  Replay(machine, RowsOf(SimulatePress(press), machine), {}, &state);
  const PressOptions later = Leaking(8);
  const auto continued = Replay(machine, RowsOf(SimulatePress(later), machine), state);
  ASSERT_FALSE(continued.empty());
  const Estimate* leak = Find(continued.front(), "internal_leakage.G");
  ASSERT_NE(leak, nullptr) << "known from the first stroke on";
  EXPECT_NEAR(leak->value, 6e-12, 4 * leak->std);
}

TEST(AddedEffects, AStateOfAnotherModelIsRefused) {
  const PressOptions press = Leaking();
  std::vector<std::uint8_t> state;
  Replay(MachineFor(press), RowsOf(SimulatePress(press), MachineFor(press)), {}, &state);
  auto pipeline = Pipeline::Create(WithLeak(press), 0.002, [](StrokeRecord&&) {});
  ASSERT_TRUE(pipeline.has_value());
  EXPECT_FALSE((*pipeline)->RestoreState(state).has_value());
}

TEST(AddedEffects, AValueThatIsNoParameterOfTheEffectIsNamed) {
  Machine machine = WithLeak(Leaking());
  machine.effect_values["internal_leakage"]["p_crack"] = 1e7;
  const auto pipeline = Pipeline::Create(machine, 0.002, [](StrokeRecord&&) {});
  ASSERT_FALSE(pipeline.has_value());
  EXPECT_THAT(pipeline.error().text, HasSubstr("p_crack"));
}

}  // namespace
}  // namespace hydroscope
