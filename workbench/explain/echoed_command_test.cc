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

TEST(EchoedCommand, SignalsThatSeemLateBehindItAreInDoubt) {
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
  machine.log.time_column = "t";
  auto strokes = ReadStrokes(path, machine, KeepSamples::kYes);
  ASSERT_TRUE(strokes) << strokes.error().text;
  EXPECT_THAT(strokes->notes, Contains(HasSubstr("y_v repeats U_v")));
  const auto x = ExplainStrokes(std::move(*strokes));
  ASSERT_TRUE(x) << x.error().text;
  EXPECT_THAT(x->explanation.set, Contains(HasSubstr("position_signal")));
  EXPECT_TRUE(x->explanation.partial);
  EXPECT_THAT(x->explanation.doubt.english, HasSubstr("y_v is not measured"));
}

}  // namespace
}  // namespace hydroscope
