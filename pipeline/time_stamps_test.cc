#include "pipeline/time_stamps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/records/quality.h"
#include "pipeline/batch_fit.h"

namespace hydroscope {
namespace {

using testing::HasSubstr;

Machine CushionOfFourColumns() {
  Machine machine;
  machine.name = "cushion";
  for (const char* name : {"p_A", "z", "y_v"}) {
    SignalSpec signal;
    signal.name = signal.column = name;
    machine.signals.push_back(signal);
  }
  machine.geometry["A_A"] = {0.01, 0};
  machine.geometry["dp_nom"] = {35e5, 0};
  machine.geometry["p_t"] = {0, 0};
  machine.gate.bounds = {{"y_v", false, 0.04, std::nullopt}};
  return machine;
}

TEST(CoarseTimeStamps, AreToldFromAFewRowsThatAreThereTwice) {
  LogCounters read;
  read.rows = 1000;
  read.flagged[8] = 3 * 900;
  static_assert(quality::kDuplicate == 1 << 8);
  EXPECT_THAT(CoarseTimeStamps(read, 3).english, HasSubstr("90 % of the rows repeat the time stamp"));
  read.flagged[8] = 3 * 150;
  EXPECT_THAT(CoarseTimeStamps(read, 3).english, HasSubstr("15 % of the rows"));
  read.flagged[8] = 3 * 50;
  EXPECT_TRUE(CoarseTimeStamps(read, 3).empty());
}

TEST(CoarseTimeStamps, AreTheCauseThatALogWithoutStrokesIsRefusedFor) {
  const std::string path = testing::TempDir() + "/coarse_stamps.csv";
  std::ofstream log(path);
  log << "t,p_A,z,y_v\n";
  for (int k = 0; k < 2000; ++k)  // of two rates: no even rows
    log << 0.01 * (k < 1000 ? k / 10 : 100 + (k - 1000) / 37) << "," << 5e6 + k << "," << 0.2 - 1e-4 * k
        << "," << 0.1 + 1e-5 * k << "\n";
  log.close();
  const auto strokes = ReadStrokes(path, CushionOfFourColumns());
  ASSERT_FALSE(strokes);
  EXPECT_THAT(strokes.error().text, HasSubstr("of the rows repeat the time stamp"));
}

}  // namespace
}  // namespace hydroscope
