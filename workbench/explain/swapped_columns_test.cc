// A machine file that takes two pressures for one another is told so, whatever its model makes of them: nothing is concluded.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "simulator/die_cushion/log_format.h"
#include "studies/simulated_strokes.h"
#include "workbench/explain/explain_log.h"

namespace hydroscope {
namespace {

using testing::Contains;
using testing::HasSubstr;

Result<ExplainResult> ExplainedWith(const std::string& path, Machine machine, const std::string& one,
                                    const std::string& other) {
  for (SignalSpec& signal : machine.signals)
    signal.column = signal.name == one ? other : signal.name == other ? one : signal.name;
  return ExplainStrokes(TRY(ReadStrokes(path, machine, KeepSamples::kYes)));
}

class SwappedColumns : public testing::Test {
 protected:
  /// The log of a press in a file, and its machine file.
  void Write(const PressOptions& options, double scale = 1) {
    SimulatedLog log = SimulatePress(options);
    for (double& pressure : log.p_A) pressure *= scale;
    std::string text(kPressLogHeader);
    for (std::size_t row = 0; row < log.rows(); ++row) AppendPressLine(log.Row(row), text);
    std::ofstream(path_) << text;
    machine_ = MachineFor(options);
    for (SignalSpec& signal : machine_.signals)
      if (signal.name == "T_oil") signal.unit = "degC";
    machine_.log.time_column = "t";
  }
  const std::string path_ = testing::TempDir() + "/swapped_columns.csv";
  Machine machine_;
};

TEST_F(SwappedColumns, LeaveNoVerdict) {
  PressOptions options;
  options.seconds = 60;
  options.effects = {{"internal_leakage", 8e-12, {}}};
  Write(options);

  const auto right = ExplainedWith(path_, machine_, "", "");
  ASSERT_TRUE(right) << right.error().text;
  EXPECT_THAT(right->explanation.set, Contains("internal_leakage"));
  EXPECT_FALSE(right->explanation.partial);
  EXPECT_TRUE(right->log.swapped.empty());

  const auto swapped = ExplainedWith(path_, machine_, "p_B", "p_0");
  ASSERT_TRUE(swapped) << swapped.error().text;
  EXPECT_THAT(swapped->explanation.no_verdict.english,
              HasSubstr("p_B (column p_0) stands above p_0 (column p_B)"));
  EXPECT_EQ(swapped->explanation.verdict, Verdict::kUnknown);
  EXPECT_TRUE(swapped->explanation.set.empty());
}

/// What holds still in the place of a pressure leaves no fit, and no other strokes would change that.
TEST_F(SwappedColumns, AreToldWhereTheyLeaveNoFit) {
  PressOptions options;
  options.seconds = 60;
  Write(options);
  const auto swapped = ExplainedWith(path_, machine_, "p_A", "p_B");
  ASSERT_FALSE(swapped);
  EXPECT_THAT(swapped.error().text, HasSubstr("the two columns are swapped in the machine file"));
}

/// A model takes up any scale of the pressure, so that only what comes out tells.
TEST_F(SwappedColumns, AWrongScaleOfThePressureIsTold) {
  PressOptions options;
  options.seconds = 60;
  for (const double scale : {1.0, 2.0, 0.1}) {
    Write(options, scale);
    const auto explained = ExplainedWith(path_, machine_, "", "");
    ASSERT_TRUE(explained) << explained.error().text;
    const auto told = testing::Contains(testing::Field(
        &Told::english, testing::MatchesRegex("K comes out as .*: check the scales of pressure.*")));
    if (scale == 1)
      EXPECT_THAT(explained->explanation.warnings, testing::Not(told));
    else
      EXPECT_THAT(explained->explanation.warnings, told) << scale;
  }
}

}  // namespace
}  // namespace hydroscope
