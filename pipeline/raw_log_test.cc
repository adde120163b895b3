#include "pipeline/raw_log.h"

#include <gtest/gtest.h>

#include "pipeline/log_trust.h"
#include "storage/storage_fixture.h"
#include "studies/simulated_strokes.h"

namespace hydroscope {
namespace {

/// Five minutes of a press in a raw window, and the same again ten years later.
class RawLog : public testing::Test {
 protected:
  RawLog() : machine_(MachineFor(Options())), press_(folder_.File()) {
    const SampleBlock rows = RowsOf(SimulatePress(Options()), machine_);
    machine_.log.sample_period = Options().sample_period;
    rows_ = static_cast<std::int64_t>(rows.time.size());
    std::vector<std::string> names;
    for (const SignalSpec& signal : machine_.signals) names.push_back(signal.name);
    const auto run = press_.Begin("live");
    for (const double later : {0.0, 3.2e8}) {
      std::vector<double> time = rows.time;
      for (double& t : time) t += later;
      EXPECT_OK(press_.database.StoreRaw(run.id, names, time, rows.signal, 1 << 30));
    }
  }

  static PressOptions Options() {
    PressOptions options = RandomMachine(1);
    options.seconds = 300;
    return options;
  }
  std::unique_ptr<LogReader> Open() const {
    auto reader = OpenRaw({folder_.File(), "", 0, {}, {}, false}, machine_);
    EXPECT_TRUE(reader) << reader.error().text;
    return std::move(*reader);
  }

  storage_test::Folder folder_;
  Machine machine_;
  storage_test::Press press_;
  std::int64_t rows_ = 0;
};

TEST_F(RawLog, IsReadAcrossYearsOfWhichNothingIsKept) {
  const auto reader = Open();
  SampleBlock block;
  while (storage_test::Value(reader->Read(block, 4096)) > 0) continue;
  EXPECT_EQ(reader->counters().rows, 2 * rows_);
}

TEST_F(RawLog, IsNamedByItsMachineAndNotByTheDatabaseAlone) {
  const std::string how = folder_.File() + "#NAME";
  const auto opened = OpenRecording(folder_.File(), machine_);
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().text.find(how), std::string::npos) << opened.error().text;
  const auto print = FingerprintRecording(folder_.File());
  ASSERT_FALSE(print);
  EXPECT_NE(print.error().text.find(how), std::string::npos) << print.error().text;
}

TEST_F(RawLog, IsReadNoFurtherThanItsFirstStrokes) {
  const auto reader = Open();
  const LogStrokes first = storage_test::Value(FirstStrokesOf(*reader, machine_));
  EXPECT_EQ(first.strokes.size(), 40u);
  EXPECT_LT(reader->counters().rows, rows_);
}

}  // namespace
}  // namespace hydroscope
