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

TEST(SwappedColumns, LeaveNoVerdict) {
  PressOptions options;
  options.seconds = 60;
  options.effects = {{"internal_leakage", 8e-12, {}}};
  const SimulatedLog log = SimulatePress(options);
  std::string text(kPressLogHeader);
  for (std::size_t row = 0; row < log.rows(); ++row) AppendPressLine(log.Row(row), text);
  const std::string path = testing::TempDir() + "/swapped_columns.csv";
  std::ofstream(path) << text;
  Machine machine = MachineFor(options);
  for (SignalSpec& signal : machine.signals)
    if (signal.name == "T_oil") signal.unit = "degC";
  machine.log.time_column = "t";

  const auto right = ExplainedWith(path, machine, "", "");
  ASSERT_TRUE(right) << right.error().text;
  EXPECT_THAT(right->explanation.set, Contains("internal_leakage"));
  EXPECT_FALSE(right->explanation.partial);
  EXPECT_TRUE(right->log.swapped.empty());

  const auto swapped = ExplainedWith(path, machine, "p_B", "p_0");
  ASSERT_TRUE(swapped) << swapped.error().text;
  EXPECT_THAT(swapped->explanation.no_verdict.english,
              HasSubstr("p_B (column p_0) stands above p_0 (column p_B)"));
  EXPECT_EQ(swapped->explanation.verdict, Verdict::kUnknown);
  EXPECT_TRUE(swapped->explanation.set.empty());
}

}  // namespace
}  // namespace hydroscope
