// Where the spool is not measured, what the valve itself does is no delay of a sensor.

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

/// Strokes of a healthy press whose spool column is the command.
Result<LogStrokes> StrokesOnTheCommand(bool command_measured) {
  PressOptions options;
  options.seconds = 60;
  SimulatedLog log = SimulatePress(options);
  std::string text(kPressLogHeader);
  for (std::size_t row = 0; row < log.rows(); ++row) {
    PressRow line = log.Row(row);
    line.y_v = 0.1 * line.U_v;
    AppendPressLine(line, text);
  }
  const std::string path = testing::TempDir() + "/echoed_command.csv";
  std::ofstream(path) << text;
  Machine machine = MachineFor(options);
  for (SignalSpec& signal : machine.signals) {
    signal.column = signal.name;
    if (signal.name == "T_oil") signal.unit = "degC";
  }
  if (!command_measured)
    std::erase_if(machine.signals, [](const SignalSpec& signal) { return signal.name == "U_v"; });
  machine.log.time_column = "t";
  return ReadStrokes(path, machine, KeepSamples::kYes);
}

TEST(EchoedCommand, SignalsThatSeemLateBehindItAreInDoubt) {
  auto strokes = StrokesOnTheCommand(true);
  ASSERT_TRUE(strokes) << strokes.error().text;
  EXPECT_THAT(strokes->notes, Contains(HasSubstr("y_v repeats U_v")));
  const auto x = ExplainStrokes(std::move(*strokes));
  ASSERT_TRUE(x) << x.error().text;
  EXPECT_THAT(x->explanation.set, Contains(HasSubstr("position_signal")));
  EXPECT_TRUE(x->explanation.partial);
  EXPECT_THAT(x->explanation.doubt.english, HasSubstr("y_v is not measured"));
}

/// Where the machine file has no command, all that is late against the spool tells it.
TEST(EchoedCommand, InPlaceOfTheReadingMakesAllOthersLate) {
  auto strokes = StrokesOnTheCommand(false);
  ASSERT_TRUE(strokes) << strokes.error().text;
  const auto x = ExplainStrokes(std::move(*strokes));
  ASSERT_TRUE(x) << x.error().text;
  EXPECT_EQ(x->explanation.groups.size(), 2u);
  EXPECT_TRUE(x->explanation.partial);
  EXPECT_THAT(x->explanation.doubt.english, HasSubstr("y_v that comes early looks the same"));
}

}  // namespace
}  // namespace hydroscope
